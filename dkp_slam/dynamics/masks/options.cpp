#include "dkp_slam/config/option_list.h"
#include "dkp_slam/dynamics/masks/clustering.h"
#include "dkp_slam/dynamics/masks/mask_depth_choice.h"

namespace dkp_slam {

void SegmentOptions::describe(OptionList& list) {
  list.add("step_constant", step_constant, at_least(0), "metres",
           "depth step between neighbours of one surface, at no depth");
  list.add("step_quadratic", step_quadratic, at_least(0), "1/metre",
           "step that depth squared adds");
  list.add("flat_constant", flat_constant, at_least(0), "metres",
           "off its plane for a flat surface (root mean square), at no depth");
  list.add("flat_quadratic", flat_quadratic, at_least(0), "1/metre", "that depth squared adds");
  list.add("flat_area", flat_area, at_least(0), "pixels of the view",
           "smaller pieces are not called flat");
  list.add("thing_area", thing_area, at_least(0), "square metres",
           "facing the camera, above which a flat surface is nobody's, even if it moves");
}

void SegmentOptions::check() const { check_options(*this); }

void FlatPatchOptions::describe(OptionList& list) {
  list.add("thickness_constant", thickness_constant, at_least(0), "metres",
           "half thickness of a flat patch at no depth");
  list.add("thickness_quadratic", thickness_quadratic, at_least(0), "1/metre",
           "half thickness that depth squared adds");
  list.add("max_depth", max_depth, above(0), "metres", "beyond it nothing can be told");
  list.add("min_area", min_area, at_least(0), "square metres", "facing the camera");
  list.add("max_widening", max_widening, at_least(1), "",
           "times its pixels at twice the thickness");
  list.add("iterations", iterations, between(1, 100000), "", "of RANSAC");
  list.add("max_per_segment", max_per_segment, at_least(0), "", "looked at in one surface");
}

void FlatPatchOptions::check() const { check_options(*this); }

void MaskDepthOptions::describe(OptionList& list) {
  list.add("every", every, at_least(0), "frames",
           "masks are cut from both depth images where a known delay gives two; 0: never");
  list.add("spread", spread, above(0), "",
           "standard deviation of one comparison, of the gradients' sum");
  list.add("sigmas", sigmas, at_least(0), "", "by which the chosen image must fit better");
  list.add("forget", forget, between(0, 1), "", "weight of what was seen, a comparison later");
}

void MaskDepthOptions::check() const { check_options(*this); }

void ClusteringOptions::describe(OptionList& list) {
  list.add("mode", mode,
           {{ClusteringMode::adaptive, "adaptive"},
            {ClusteringMode::paper, "paper"},
            {ClusteringMode::band, "band"}},
           "K from the object's thickness, Eq. 1 to the letter, or no clusters");
  list.add("min_clusters", min_clusters, between(1, 100), "", "K at least");
  list.add("max_clusters", max_clusters, between(1, 100), "", "K at most");
  list.add("join_distance", join_distance, at_least(0), "metres",
           "clusters whose centres lie this near to the chosen one belong to it");
  list.add("band", band, at_least(0), "metres", "to each side of T, mode band");
  list.add("raw_depth_scale", raw_depth_scale, above(0), "1/metre",
           "depth units of Eq. 1, mode paper");
  list.add("remove_planes", remove_planes, "cut the static planes out of the mask");
  list.add_part("planes", planes, "of one frame, by RANSAC");
  list.add("opening", opening, between(0, 50), "pixels of the view",
           "radius that speckles fall to");
  list.add("min_blob_share", min_blob_share, between(0, 1), "",
           "of the mask; smaller pieces of it go");
  list.add("growth", growth, at_least(0), "",
           "share of the box's sides by which the mask may grow out of it");
  list.add("first_mode_share", first_mode_share, between(0, 1), "",
           "of a box's central half that a depth mode needs at first sight");
  list.add_part("segments", segments, "surfaces without a step in depth");
  list.add_part("flat_patches", flat_patches, "in a surface: monitors beside people");
  list.add("inside_share", inside_share, between(0, 1), "",
           "of a surface that lies in the box, to be a part of the object");
  list.add("crumb_area", crumb_area, at_least(0), "pixels of the view",
           "of small surfaces that join the mask beside them");
  list.add("crumb_step", crumb_step, at_least(0), "metres", "in depth between them and the mask");
  list.add("crumb_reach", crumb_reach, between(0, 50), "pixels of the view",
           "between them and the mask");
  list.order("min_clusters", "max_clusters");
}

void ClusteringOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
