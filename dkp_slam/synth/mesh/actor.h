#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dkp_slam/synth/mesh/mesh.h"

namespace dkp_slam {

/// Something of the synthetic world that may move. World frame: z up, the floor at 0, metres.
class Actor {
 public:
  virtual ~Actor() = default;
  /// Triangles, texture coordinates and textures; they never change.
  virtual const std::vector<Mesh>& meshes() const = 0;
  /// Where the vertices of `meshes()` are in the world at a time, seconds from 0.
  virtual std::vector<MeshPose> at(double time) const = 0;
  /// What a detector calls it, a name of COCO's classes; empty when no detector knows it.
  virtual std::string class_name() const = 0;
};

/// A thing that keeps its shape: a chair that is pushed, a drawer, a box in somebody's hands.
class RigidActor : public Actor {
 public:
  using Motion = std::function<Se3(double time)>;

  RigidActor(std::vector<Mesh> meshes, Motion world_from_actor, std::string class_name = "")
      : meshes_(std::move(meshes)),
        world_from_actor_(std::move(world_from_actor)),
        class_name_(std::move(class_name)) {}
  const std::vector<Mesh>& meshes() const override { return meshes_; }
  std::vector<MeshPose> at(double time) const override {
    const Se3 pose = world_from_actor_(time);
    std::vector<MeshPose> posed;
    for (const Mesh& mesh : meshes_) posed.push_back(pose * mesh.rest);
    return posed;
  }
  std::string class_name() const override { return class_name_; }

 private:
  std::vector<Mesh> meshes_;
  Motion world_from_actor_;
  std::string class_name_;
};

}  // namespace dkp_slam
