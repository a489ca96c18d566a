#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dkp_slam/synth/figure/figure_options.h"
#include "dkp_slam/synth/mesh/actor.h"

namespace dkp_slam {

/// A jointed, clothed person with skin, hair and a face. Same options, same bytes.
class Figure : public Actor {
 public:
  explicit Figure(const FigureOptions& options);
  ~Figure() override;

  const std::vector<Mesh>& meshes() const override;
  std::vector<MeshPose> at(double time) const override;
  std::string class_name() const override { return "person"; }

  /// Where the figure stands: x ahead, z up, on the floor; a pushed chair goes along with it.
  Se3 root(double time) const;
  /// Middle between the hands, x ahead, z up: what is carried goes along with it.
  Se3 hands(double time) const;

 private:
  struct Body;
  std::unique_ptr<const Body> body_;
};

}  // namespace dkp_slam
