#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "dkp_slam/synth/mesh/actor.h"

namespace dkp_slam {

/// Where a ray meets a triangle.
struct SurfaceHit {
  int surface = -1;          ///< index of `EmbreeScene::surface`; -1: nothing
  int triangle = 0;          ///< of that surface
  float u = 0.0F, v = 0.0F;  ///< point = (1 - u - v) p0 + u p1 + v p2
  float distance = 0.0F;     ///< in lengths of the ray's direction
  bool operator==(const SurfaceHit&) const = default;
};

/// A ray: metres, world frame.
struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;
  float longest = 1e30F;  ///< ends after so many lengths of `direction`
};

/// As many rays as the widest processors trace at once; on others Embree halves the packets.
constexpr int packet_size = 16;
using Rays = std::array<Ray, packet_size>;
using SurfaceHits = std::array<SurfaceHit, packet_size>;

/// A mesh as the tracer sees it: of an actor, or standing still.
struct Surface {
  const Mesh* mesh = nullptr;
  int instance = 0;  ///< 0 stands still, i the i-th actor, from 1
  /// Of an actor: at the middle, the start and the end of the time of `pose_actors`.
  MeshPose middle;
  std::vector<Eigen::Vector3f> first, last;
  const MeshPose& pose() const { return instance == 0 ? mesh->rest : middle; }
};

/// The triangles of a place and its actors in Embree's trees (Wald et al., SIGGRAPH 2014).
class EmbreeScene {
 public:
  EmbreeScene(std::vector<Mesh> still, std::vector<std::shared_ptr<const Actor>> actors);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Moves the actors: what is traced from now on happens between the two times, seconds, which
  /// are cut into moments at which the actors stand still: one, three, five or more.
  void pose_actors(double begin, double end);
  int moments() const;
  /// The one in the middle of the time.
  int middle() const { return moments() / 2; }
  /// The one that a time belongs to: 0 at the first of `pose_actors`' times, 1 at the second.
  int moment_at(float share) const;

  /// What rays may meet.
  struct Among {
    bool still = true;  ///< what stands still
    int moment = -1;    ///< the actors as they are then; -1: none of them
  };
  /// Nearest hits of the first `count` rays. `alike`: they go about the same way, which is faster.
  SurfaceHits trace(const Rays& rays, int count, Among among, bool alike = true) const;
  /// Which of the first `count` rays meet anything: bit i of the result.
  unsigned blocked(const Rays& rays, int count, Among among) const;

  int surfaces() const { return static_cast<int>(surfaces_.size()); }
  int still_surfaces() const { return static_cast<int>(still_.size()); }
  const Surface& surface(int index) const { return surfaces_[static_cast<std::size_t>(index)]; }

 private:
  struct Trees;

  void build_still();
  void pose_actor(std::size_t actor, double begin, double end);

  std::vector<Mesh> still_;
  std::vector<std::shared_ptr<const Actor>> actors_;
  std::vector<Surface> surfaces_;
  std::unique_ptr<Trees> trees_;
};

}  // namespace dkp_slam
