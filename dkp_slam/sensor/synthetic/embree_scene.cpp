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

// Limbs swing by less than a millimetre off a straight line in this time.
constexpr double longest_step = 0.01;  // seconds

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

/// Into Embree's layout; lanes from `count` on stay idle.
template <class Packet>
void fill(const Rays& rays, int count, Packet* ray, int* valid) {
  for (int i = 0; i < packet_size; ++i) {
    const Ray& r = rays[static_cast<std::size_t>(i < count ? i : 0)];
    valid[i] = i < count ? -1 : 0;
    ray->org_x[i] = r.origin.x();
    ray->org_y[i] = r.origin.y();
    ray->org_z[i] = r.origin.z();
    ray->dir_x[i] = r.direction.x();
    ray->dir_y[i] = r.direction.y();
    ray->dir_z[i] = r.direction.z();
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
  RTCScene still = nullptr, moving = nullptr;
  std::vector<RTCGeometry> actor_geometries;  ///< owned by `moving`
  int time_steps = 0;                         ///< of these

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
    if (moving != nullptr) rtcReleaseScene(moving);
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
  if (t.time_steps == time_steps) return;
  if (t.moving != nullptr) rtcReleaseScene(t.moving);
  t.moving = rtcNewScene(t.device);
  rtcSetSceneFlags(t.moving,
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  rtcSetSceneBuildQuality(t.moving, RTC_BUILD_QUALITY_LOW);
  t.actor_geometries.clear();
  for (std::size_t i = still_.size(); i < surfaces_.size(); ++i) {
    RTCGeometry geometry = new_geometry(t.device, *surfaces_[i].mesh, time_steps);
    rtcAttachGeometryByID(t.moving, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
    t.actor_geometries.push_back(geometry);
  }
  t.time_steps = time_steps;
}

void EmbreeScene::pose_actors(double begin, double end) {
  // An odd number of steps: one of them is the middle, where the depth is measured.
  const double span = end - begin;
  const int steps =
      span > 0.0 ? 1 + 2 * std::max(1, static_cast<int>(std::ceil(span / (2.0 * longest_step))))
                 : 1;
  attach_actor_meshes(steps);
  std::vector<int> first_surface;
  int next = still_surfaces();
  for (const auto& actor : actors_) {
    first_surface.push_back(next);
    next += static_cast<int>(actor->meshes().size());
  }
  cv::parallel_for_({0, static_cast<int>(actors_.size())}, [&](const cv::Range& range) {
    for (int a = range.start; a < range.end; ++a) {
      for (int step = 0; step < steps; ++step) {
        const double time = steps > 1 ? begin + span * step / (steps - 1) : begin;
        std::vector<MeshPose> poses = actors_[static_cast<std::size_t>(a)]->at(time);
        for (std::size_t m = 0; m < poses.size(); ++m) {
          const std::size_t index = static_cast<std::size_t>(first_surface[a]) + m;
          Surface& surface = surfaces_[index];
          if (poses[m].vertices.size() != surface.mesh->rest.vertices.size()) {
            throw Error("synthetic actor: a pose has another number of vertices than its mesh");
          }
          copy_vertices(poses[m].vertices, trees_->actor_geometries[index - still_.size()], step);
          if (step == 0) surface.first = poses[m].vertices;
          if (step == steps - 1) surface.last = poses[m].vertices;
          if (step == steps / 2) surface.middle = std::move(poses[m]);
        }
      }
    }
  });
  for (RTCGeometry geometry : trees_->actor_geometries) rtcCommitGeometry(geometry);
  rtcCommitScene(trees_->moving);
}

SurfaceHits EmbreeScene::trace(const Rays& rays, int count, What what) const {
  RTCRayHit8 packet;
  alignas(32) int valid[packet_size];
  fill(rays, count, &packet.ray, valid);
  std::fill_n(packet.hit.geomID, packet_size, RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  // The second search begins with what the first one found: the nearer hit stays.
  if (what != What::moving) rtcIntersect8(valid, trees_->still, &context, &packet);
  if (what != What::still && !actors_.empty()) {
    rtcIntersect8(valid, trees_->moving, &context, &packet);
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
  RTCRay8 packet;
  alignas(32) int valid[packet_size];
  fill(rays, count, &packet, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (what != What::moving) rtcOccluded8(valid, trees_->still, &context, &packet);
  if (what != What::still && !actors_.empty()) {
    // A ray that is blocked already has a negative end and is skipped.
    for (int i = 0; i < packet_size; ++i) valid[i] = packet.tfar[i] < 0.0F ? 0 : valid[i];
    rtcOccluded8(valid, trees_->moving, &context, &packet);
  }
  unsigned bits = 0;
  for (int i = 0; i < count; ++i) bits |= packet.tfar[i] < 0.0F ? 1U << i : 0U;
  return bits;
}

}  // namespace dkp_slam
