#include "dkp_slam/sensor/synthetic/embree_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

// Limbs swing by a millimetre at most off a straight line in this time.
constexpr double longest_step = 0.02;  // seconds
constexpr int middle_step = -1;        // the pose in the middle of the time

void copy_vertices(const std::vector<Eigen::Vector3f>& vertices, RTCGeometry geometry, int step) {
  void* buffer =
      rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step));
  std::memcpy(buffer, vertices.data(), vertices.size() * sizeof(Eigen::Vector3f));
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step));
}

RTCGeometry new_geometry(RTCDevice device, const Mesh& mesh, int time_steps) {
  const auto vertices = mesh.rest.vertices.size();
  if (mesh.uv.size() != vertices || mesh.rest.normals.size() != vertices || !mesh.texture) {
    throw Error("synthetic mesh: needs a normal and a uv for each vertex, and a texture");
  }
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(time_steps));
  for (int step = 0; step < time_steps; ++step) {
    rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step),
                            RTC_FORMAT_FLOAT3, sizeof(Eigen::Vector3f), vertices);
  }
  auto* index = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) *index++ = static_cast<std::uint32_t>(triangle[i]);
  }
  return geometry;
}

/// Embree's packets miss what they should hit when a direction lies almost in an axis' plane and
/// its reciprocal overflows; this is off by 5 micrometres at 5 metres.
float off_zero(float component) {
  constexpr float least = 1e-6F;
  return std::abs(component) < least ? std::copysign(least, component) : component;
}

/// Into Embree's layout; lanes from `count` on stay idle.
template <class Packet>
void fill(const Rays& rays, int count, Packet* ray, int* valid) {
  for (int i = 0; i < packet_size; ++i) {
    const Ray& r = rays[static_cast<std::size_t>(i < count ? i : 0)];
    valid[i] = i < count ? -1 : 0;
    ray->org_x[i] = r.origin.x();
    ray->org_y[i] = r.origin.y();
    ray->org_z[i] = r.origin.z();
    ray->dir_x[i] = off_zero(r.direction.x());
    ray->dir_y[i] = off_zero(r.direction.y());
    ray->dir_z[i] = off_zero(r.direction.z());
    ray->tnear[i] = 0.0F;
    ray->tfar[i] = r.longest;
    ray->time[i] = r.moment;
    ray->mask[i] = ~0U;
    ray->id[i] = 0;
    ray->flags[i] = 0;
  }
}

}  // namespace

struct EmbreeScene::Trees {
  RTCDevice device = nullptr;
  RTCScene still = nullptr;
  /// Actors in the middle of the time, and over all of it where that is longer than a moment.
  RTCScene frozen = nullptr, moving = nullptr;
  std::vector<RTCGeometry> frozen_geometries, moving_geometries;  ///< owned by the scenes
  int time_steps = 0;                                             ///< of `moving`; 1: it is idle

  // Embree's default number of threads: a limit here would hold for all of TBB in this process.
  Trees() : device(rtcNewDevice(nullptr)) {
    if (device == nullptr) {
      throw Error(fmt::format("synthetic renderer: Embree does not start (error {})",
                              static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    still = rtcNewScene(device);
    // Watertight edges: no ray slips through between two triangles.
    rtcSetSceneFlags(still, RTC_SCENE_FLAG_ROBUST);
  }
  ~Trees() {
    for (RTCScene actors : {frozen, moving}) {
      if (actors != nullptr) rtcReleaseScene(actors);
    }
    if (still != nullptr) rtcReleaseScene(still);
    rtcReleaseDevice(device);
  }
};

EmbreeScene::EmbreeScene(std::vector<Mesh> still, std::vector<std::shared_ptr<const Actor>> actors)
    : still_(std::move(still)), actors_(std::move(actors)), trees_(std::make_unique<Trees>()) {
  constexpr std::size_t most_actors = 255;  // instances are bytes
  if (actors_.size() > most_actors) throw Error("synthetic renderer: more than 255 actors");
  for (const Mesh& mesh : still_) surfaces_.push_back({&mesh, 0, {}, {}, {}});
  for (std::size_t a = 0; a < actors_.size(); ++a) {
    for (const Mesh& mesh : actors_[a]->meshes()) {
      surfaces_.push_back({&mesh, static_cast<int>(a) + 1, {}, {}, {}});
    }
  }
  build_still();
  pose_actors(0.0, 0.0);
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::build_still() {
  for (std::size_t i = 0; i < still_.size(); ++i) {
    RTCGeometry geometry = new_geometry(trees_->device, still_[i], 1);
    copy_vertices(still_[i].rest.vertices, geometry, 0);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(trees_->still, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcSetSceneBuildQuality(trees_->still, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(trees_->still);
}

void EmbreeScene::attach_actor_meshes(int time_steps) {
  Trees& t = *trees_;
  const auto attach = [&](int steps, RTCScene* scene, std::vector<RTCGeometry>* geometries) {
    if (*scene != nullptr) rtcReleaseScene(*scene);
    *scene = rtcNewScene(t.device);
    rtcSetSceneFlags(*scene,
                     static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
    rtcSetSceneBuildQuality(*scene, RTC_BUILD_QUALITY_LOW);
    geometries->clear();
    for (std::size_t i = still_.size(); i < surfaces_.size(); ++i) {
      RTCGeometry geometry = new_geometry(t.device, *surfaces_[i].mesh, steps);
      rtcAttachGeometryByID(*scene, geometry, static_cast<unsigned>(i));
      rtcReleaseGeometry(geometry);
      geometries->push_back(geometry);
    }
  };
  if (t.frozen == nullptr) attach(1, &t.frozen, &t.frozen_geometries);
  if (time_steps > 1 && t.time_steps != time_steps) {
    attach(time_steps, &t.moving, &t.moving_geometries);
  }
  t.time_steps = time_steps;
}

void EmbreeScene::set_pose(std::size_t surface, int step, MeshPose pose) {
  Surface& s = surfaces_[surface];
  if (pose.vertices.size() != s.mesh->rest.vertices.size() ||
      pose.normals.size() != pose.vertices.size()) {
    throw Error("synthetic actor: a pose has another number of vertices than its mesh");
  }
  const std::size_t geometry = surface - still_.size();
  if (step == middle_step) {
    copy_vertices(pose.vertices, trees_->frozen_geometries[geometry], 0);
    s.middle = std::move(pose);
    return;
  }
  copy_vertices(pose.vertices, trees_->moving_geometries[geometry], step);
  if (step == 0) s.first = pose.vertices;
  if (step == trees_->time_steps - 1) s.last = std::move(pose.vertices);
}

void EmbreeScene::pose_actors(double begin, double end) {
  const double span = end - begin;
  const int steps = span > 0.0 ? 1 + static_cast<int>(std::ceil(span / longest_step)) : 1;
  attach_actor_meshes(steps);
  std::vector<std::size_t> first_surface;
  std::size_t next = still_.size();
  for (const auto& actor : actors_) {
    first_surface.push_back(next);
    next += actor->meshes().size();
  }
  const auto pose_actor = [&](std::size_t a, int step, double time) {
    std::vector<MeshPose> poses = actors_[a]->at(time);
    for (std::size_t m = 0; m < poses.size(); ++m) {
      set_pose(first_surface[a] + m, step, std::move(poses[m]));
    }
  };
  cv::parallel_for_({0, static_cast<int>(actors_.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto a = static_cast<std::size_t>(i);
      pose_actor(a, middle_step, begin + 0.5 * span);
      for (int step = 0; steps > 1 && step < steps; ++step) {
        pose_actor(a, step, begin + span * step / (steps - 1));
      }
      for (std::size_t s = first_surface[a]; steps == 1 && s < surfaces_.size(); ++s) {
        if (surfaces_[s].instance != i + 1) break;
        surfaces_[s].first = surfaces_[s].last = surfaces_[s].middle.vertices;
      }
    }
  });
  const auto commit = [](RTCScene scene, const std::vector<RTCGeometry>& geometries) {
    for (RTCGeometry geometry : geometries) rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
  };
  commit(trees_->frozen, trees_->frozen_geometries);
  // From the first pose's tree on boxes only follow their triangles: a fifth of the work.
  for (RTCGeometry geometry : trees_->frozen_geometries) {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
  }
  if (steps > 1 && !actors_.empty()) commit(trees_->moving, trees_->moving_geometries);
}

SurfaceHits EmbreeScene::trace(const Rays& rays, int count, What what, bool alike) const {
  RTCRayHit16 packet;
  alignas(64) int valid[packet_size];
  fill(rays, count, &packet.ray, valid);
  std::fill_n(packet.hit.geomID, packet_size, RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  // The second search begins with what the first one found: the nearer hit stays.
  if (what != What::frozen) rtcIntersect16(valid, trees_->still, &context, &packet);
  if (what != What::still && !actors_.empty()) {
    const bool moving = what == What::still_and_moving && trees_->time_steps > 1;
    rtcIntersect16(valid, moving ? trees_->moving : trees_->frozen, &context, &packet);
  }
  SurfaceHits hits;
  for (int i = 0; i < count; ++i) {
    if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[static_cast<std::size_t>(i)] = {static_cast<int>(packet.hit.geomID[i]),
                                         static_cast<int>(packet.hit.primID[i]), packet.hit.u[i],
                                         packet.hit.v[i], packet.ray.tfar[i]};
  }
  return hits;
}

unsigned EmbreeScene::blocked(const Rays& rays, int count, What what) const {
  RTCRay16 packet;
  alignas(64) int valid[packet_size];
  fill(rays, count, &packet, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (what != What::frozen) rtcOccluded16(valid, trees_->still, &context, &packet);
  if (what != What::still && !actors_.empty()) {
    // A ray that is blocked already has a negative end and is skipped.
    for (int i = 0; i < packet_size; ++i) valid[i] = packet.tfar[i] < 0.0F ? 0 : valid[i];
    rtcOccluded16(valid, trees_->frozen, &context, &packet);
  }
  unsigned bits = 0;
  for (int i = 0; i < count; ++i) bits |= packet.tfar[i] < 0.0F ? 1U << i : 0U;
  return bits;
}

}  // namespace dkp_slam
