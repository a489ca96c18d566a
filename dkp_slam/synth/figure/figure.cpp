#include "dkp_slam/synth/figure/figure.h"

#include "dkp_slam/synth/figure/figure_body.h"
#include "dkp_slam/synth/figure/figure_motion.h"

namespace dkp_slam {

struct Figure::Body {
  explicit Body(const FigureOptions& options)
      : look(random_look(options.seed)),
        motion(options, look),
        skins(figure_body(look, paint_figure(look))) {
    for (const SkinnedMesh& skin : skins) meshes.push_back(skin.mesh);
  }

  FigureLook look;
  FigureMotion motion;
  std::vector<SkinnedMesh> skins;
  std::vector<Mesh> meshes;
};

Figure::Figure(const FigureOptions& options) : body_(std::make_unique<Body>(options)) {}

Figure::~Figure() = default;

const std::vector<Mesh>& Figure::meshes() const { return body_->meshes; }

std::vector<MeshPose> Figure::at(double time) const {
  return skinned(body_->skins, body_->motion.rest(), body_->motion.joints(time));
}

Se3 Figure::root(double time) const { return body_->motion.root(time); }

Se3 Figure::hands(double time) const { return body_->motion.hands(time); }

}  // namespace dkp_slam
