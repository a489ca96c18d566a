#include "dkp_slam/config/option_list.h"
#include "dkp_slam/localization/alignment.h"
#include "dkp_slam/localization/matcher.h"
#include "dkp_slam/localization/place_index.h"

namespace dkp_slam {

void MatchOptions::describe(OptionList& list) {
  list.add("loose", loose, between(0, 256), "bits",
           "descriptors may differ, where geometry says where to look");
  list.add("strict", strict, between(0, 256), "bits", "descriptors may differ, where it does not");
  list.add("ratio_projection", ratio_projection, positive_share(), "",
           "best to second best distance on the same level, where geometry says where to look");
  list.add("ratio_brute_force", ratio_brute_force, positive_share(), "",
           "best to second best distance, where it does not");
}

void MatchOptions::check() const { check_options(*this); }

void AlignmentOptions::describe(OptionList& list) {
  list.add("samples", samples, between(1, 1000000), "", "of three matches, at most");
  list.add("confidence", confidence, between(0.5, 0.999999), "",
           "that a good sample was met; then no more are drawn");
  list.add("pixel_bound", pixel_bound, above(0), "pixels", "error of an inlier, on level 0");
  list.add("least_side", least_side, at_least(0), "metres", "of the triangle of a sample");
  list.add("least_inliers", least_inliers, at_least(3), "", "that agree on a pose");
}

void AlignmentOptions::check() const { check_options(*this); }

void PlaceIndexOptions::describe(OptionList& list) {
  list.add("tables", tables, between(1, 16), "", "hash tables, each of 16 of the 256 bits");
  list.add("match_bits", match_bits, between(0, 256), "bits",
           "by which a feature may differ from a landmark it votes for");
  list.add("signature_bits", signature_bits, between(0, 32), "bits",
           "of 32 further ones, compared first");
  list.add("another_look_bits", another_look_bits, between(0, 256), "bits",
           "by which a landmark must look different to get another descriptor");
  list.add("most_looks", most_looks, between(1, 100), "", "descriptors of one landmark");
  list.add("most_new", most_new, at_least(0), "", "landmarks that one keyframe may add");
  list.add("busy_bucket", busy_bucket, at_least(1), "", "entries; a longer list is passed over");
  list.add("tidied_per_keyframe", tidied_per_keyframe, at_least(1), "",
           "entries looked through for landmarks that have gone");
  list.add("least_vote_share", least_vote_share, between(0, 1), "",
           "of the best candidate's votes that a candidate has");
  list.add("least_group_share", least_group_share, between(0, 1), "",
           "of the best group's score that a group has");
  list.add("group", group, at_least(0), "",
           "keyframes that share most with one and add to its score");
  list.add("least_votes", least_votes, at_least(1), "",
           "features in common that are more than chance");
}

void PlaceIndexOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
