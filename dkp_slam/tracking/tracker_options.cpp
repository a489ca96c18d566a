#include "dkp_slam/config/option_list.h"
#include "dkp_slam/tracking/tracker.h"

namespace dkp_slam {

void TrackerOptions::describe(OptionList& list) {
  list.add("least_to_start", least_to_start, at_least(3), "",
           "static features with depth for the first keyframe");
  list.add("least_from_motion", least_from_motion, at_least(3), "",
           "matches by the motion model; with fewer the window is doubled");
  list.add("sure_from_motion", sure_from_motion, at_least(0), "",
           "landmarks by the measured motion; with fewer constant velocity is tried, too");
  list.add("least_inliers", least_inliers, at_least(3), "",
           "landmarks tracked; with fewer the frame is lost");
  list.add("motion_radius", motion_radius, above(0), "pixels",
           "search window about the predicted place, on level 0");
  list.add("local_keyframes", local_keyframes, at_least(1), "",
           "keyframes that make the local map");
  list.add("least_keyframe_features", least_keyframe_features, at_least(0), "",
           "static features that a keyframe needs");
  list.add("keyframe_interval", keyframe_interval, above(0), "seconds",
           "a keyframe is due after this time at the latest");
  list.add("keyframe_share", keyframe_share, between(0, 1), "",
           "of the reference keyframe's landmarks; with fewer tracked a keyframe is due");
  list.add("urgent_share", urgent_share, between(0, 1), "",
           "below it the keyframe does not wait for the bundle adjustment under way");
  list.add("left_share", left_share, between(0, 1), "",
           "of the most landmarks tracked since the last keyframe; with fewer a keyframe is due");
  list.add("left_least", left_least, at_least(0), "", "landmarks that the most must have been");
  list.add("longest_carry", longest_carry, at_least(0), "seconds",
           "without the map in which a frame is placed by its measured motion");
  list.add("least_to_go_on", least_to_go_on, at_least(3), "",
           "static features with depth; with so many that the map does not know it goes on there, "
           "or another map does");
  list.add("longest_unmapped", longest_unmapped, at_least(0), "seconds",
           "by which frames are carried over what the map does not know until it goes on there");
  list.add("longest_steady", longest_steady, at_least(0), "seconds",
           "without the map in which constant velocity is assumed");
  list.add("longest_loss", longest_loss, at_least(0), "seconds",
           "without a localised frame until another map is begun; twice the time that the map was "
           "followed where that is less");
  list.add("most_first_speed", most_first_speed, above(0), "m/s",
           "by which a map's second frame may lie from its first; beyond, another map is begun");
  list.add("least_for_motion", least_for_motion, at_least(3), "",
           "landmarks tracked in a frame whose motion is believed, and after a gap its place");
  list.add("most_acceleration", most_acceleration, above(0), "m/s^2",
           "for a measured motion to be believed against constant velocity");
  list.add("most_angular_acceleration", most_angular_acceleration, above(0), "rad/s^2",
           "for a measured motion to be believed against constant velocity");
  list.add("use_belief", use_belief,
           "remember of landmarks whether they were seen to move; mode paper goes without");
  list.add("find_room", find_room,
           "where near and far landmarks put the camera elsewhere, follow those that extend as far "
           "as a room; modes off and paper go without");
  list.add_part("belief", belief, "how evidence from single frames adds up in a landmark");
  list.order("urgent_share", "keyframe_share");
}

void TrackerOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
