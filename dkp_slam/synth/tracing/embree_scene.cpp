#include "dkp_slam/synth/tracing/embree_scene.h"

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

// The fastest limbs move by two pixels meanwhile; the camera's own motion is each ray's.
constexpr double longest_moment = 0.003;  // seconds

void copy_vertices(const std::vector<Eigen::Vector3f>& vertices, RTCGeometry geometry) {
  void* buffer = rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  std::memcpy(buffer, vertices.data(), vertices.size() * sizeof(Eigen::Vector3f));
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
}

RTCGeometry new_geometry(RTCDevice device, const Mesh& mesh) {
  const auto vertices = mesh.rest.vertices.size();
  if (mesh.uv.size() != vertices || mesh.rest.normals.size() != vertices || !mesh.texture) {
    throw Error("synthetic mesh: needs a normal and a uv for each vertex, and a texture");
  }
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                          sizeof(Eigen::Vector3f), vertices);
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
    ray->time[i] = 0.0F;
    ray->mask[i] = ~0U;
    ray->id[i] = 0;
    ray->flags[i] = 0;
  }
}

/// Of each set of vector instructions Embree makes slightly other pictures, enough to lead the
/// system astray in another frame: so the one that all x86-64 processors have. (Its approximate
/// reciprocals may still be their maker's.) It costs an eighth of the speed.
#ifdef __x86_64__
constexpr const char* embree_options = "isa=sse2";
#else
constexpr const char* embree_options = nullptr;
#endif

}  // namespace

struct EmbreeScene::Trees {
  /// The actors at one moment.
  struct Moment {
    RTCScene scene = nullptr;
    std::vector<RTCGeometry> geometries;  ///< owned by the scene
  };

  RTCDevice device = nullptr;
  RTCScene still = nullptr;
  std::vector<Moment> moments;

  // Embree's default number of threads: a limit here would hold for all of TBB in this process.
  Trees() : device(rtcNewDevice(embree_options)) {
    if (device == nullptr) {
      throw Error(fmt::format("synthetic renderer: Embree does not start (error {})",
                              static_cast<int>(rtcGetDeviceError(nullptr))));
    }
    still = rtcNewScene(device);
    // Watertight edges: no ray slips through between two triangles.
    rtcSetSceneFlags(still, RTC_SCENE_FLAG_ROBUST);
  }
  ~Trees() {
    for (const Moment& moment : moments) rtcReleaseScene(moment.scene);
    if (still != nullptr) rtcReleaseScene(still);
    rtcReleaseDevice(device);
  }

  void add_moment(const std::vector<Surface>& surfaces, std::size_t first) {
    Moment& moment = moments.emplace_back();
    moment.scene = rtcNewScene(device);
    rtcSetSceneFlags(moment.scene,
                     static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
    rtcSetSceneBuildQuality(moment.scene, RTC_BUILD_QUALITY_LOW);
    for (std::size_t i = first; i < surfaces.size(); ++i) {
      RTCGeometry geometry = new_geometry(device, *surfaces[i].mesh);
      rtcAttachGeometryByID(moment.scene, geometry, static_cast<unsigned>(i));
      rtcReleaseGeometry(geometry);
      moment.geometries.push_back(geometry);
    }
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
    RTCGeometry geometry = new_geometry(trees_->device, still_[i]);
    copy_vertices(still_[i].rest.vertices, geometry);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(trees_->still, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcSetSceneBuildQuality(trees_->still, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(trees_->still);
}

int EmbreeScene::moments() const { return static_cast<int>(trees_->moments.size()); }

int EmbreeScene::moment_at(float share) const {
  return std::clamp(static_cast<int>(share * static_cast<float>(moments())), 0, moments() - 1);
}

/// Gives the actor's pose to its surfaces and to all trees.
void EmbreeScene::pose_actor(std::size_t actor, double begin, double end) {
  const auto first = static_cast<std::size_t>(
      std::find_if(surfaces_.begin(), surfaces_.end(),
                   [&](const Surface& s) { return s.instance == static_cast<int>(actor) + 1; }) -
      surfaces_.begin());
  const auto pose_at = [&](double time) {
    std::vector<MeshPose> poses = actors_[actor]->at(time);
    for (std::size_t m = 0; m < poses.size(); ++m) {
      const std::size_t vertices = surfaces_[first + m].mesh->rest.vertices.size();
      if (poses[m].vertices.size() == vertices && poses[m].normals.size() == vertices) continue;
      throw Error("synthetic actor: a pose has another number of vertices than its mesh");
    }
    return poses;
  };
  for (int moment = 0; moment < moments(); ++moment) {
    std::vector<MeshPose> poses = pose_at(begin + (end - begin) * (moment + 0.5) / moments());
    for (std::size_t m = 0; m < poses.size(); ++m) {
      copy_vertices(
          poses[m].vertices,
          trees_->moments[static_cast<std::size_t>(moment)].geometries[first + m - still_.size()]);
      if (moment == middle()) surfaces_[first + m].middle = std::move(poses[m]);
    }
  }
  std::vector<MeshPose> at_begin = pose_at(begin), at_end = pose_at(end);
  for (std::size_t m = 0; m < at_begin.size(); ++m) {
    surfaces_[first + m].first = std::move(at_begin[m].vertices);
    surfaces_[first + m].last = std::move(at_end[m].vertices);
  }
}

void EmbreeScene::pose_actors(double begin, double end) {
  const int pairs = static_cast<int>(std::ceil((end - begin) / longest_moment / 2.0 - 0.5));
  const auto wanted = static_cast<std::size_t>(1 + 2 * std::max(pairs, 0));
  if (trees_->moments.size() > wanted) {
    for (std::size_t i = wanted; i < trees_->moments.size(); ++i) {
      rtcReleaseScene(trees_->moments[i].scene);
    }
    trees_->moments.resize(wanted);
  }
  while (trees_->moments.size() < wanted) trees_->add_moment(surfaces_, still_.size());
  cv::parallel_for_({0, static_cast<int>(actors_.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      pose_actor(static_cast<std::size_t>(i), begin, end);
    }
  });
  for (const Trees::Moment& moment : trees_->moments) {
    for (RTCGeometry geometry : moment.geometries) rtcCommitGeometry(geometry);
    rtcCommitScene(moment.scene);
    // From the first pose's tree on boxes only follow their triangles: a fifth of the work.
    for (RTCGeometry geometry : moment.geometries) {
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    }
  }
}

SurfaceHits EmbreeScene::trace(const Rays& rays, int count, Among among, bool alike) const {
  RTCRayHit16 packet;
  alignas(64) int valid[packet_size];
  fill(rays, count, &packet.ray, valid);
  std::fill_n(packet.hit.geomID, packet_size, RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  // The second search begins with what the first one found: the nearer hit stays.
  if (among.still) rtcIntersect16(valid, trees_->still, &context, &packet);
  if (among.moment >= 0 && !actors_.empty()) {
    const auto moment = static_cast<std::size_t>(among.moment);
    rtcIntersect16(valid, trees_->moments[moment].scene, &context, &packet);
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

unsigned EmbreeScene::blocked(const Rays& rays, int count, Among among) const {
  RTCRay16 packet;
  alignas(64) int valid[packet_size];
  fill(rays, count, &packet, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (among.still) rtcOccluded16(valid, trees_->still, &context, &packet);
  if (among.moment >= 0 && !actors_.empty()) {
    // A ray that is blocked already has a negative end and is skipped.
    for (int i = 0; i < packet_size; ++i) valid[i] = packet.tfar[i] < 0.0F ? 0 : valid[i];
    const auto moment = static_cast<std::size_t>(among.moment);
    rtcOccluded16(valid, trees_->moments[moment].scene, &context, &packet);
  }
  unsigned bits = 0;
  for (int i = 0; i < count; ++i) bits |= packet.tfar[i] < 0.0F ? 1U << i : 0U;
  return bits;
}

}  // namespace dkp_slam
