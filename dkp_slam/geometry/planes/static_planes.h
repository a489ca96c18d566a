#pragma once

#include <cstdint>
#include <vector>

#include "dkp_slam/geometry/planes/depth_view.h"
#include "dkp_slam/geometry/planes/plane.h"
#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {

class OptionList;

struct StaticPlanesOptions {
  /// Seconds that a plane is remembered after it was last found anew: the time that a person takes
  /// to walk past the camera.
  double memory = 2.0;
  /// Seconds over which a plane must have been found in its place to be remembered at all:
  /// a person's back is flat for some frames, but does not stay.
  double proof = 0.5;
  /// Over which a plane of this size, metres, must have been found: nobody's back is that large,
  /// but a plane through two people may be.
  double large_proof = 0.1;
  double large_extent = 2.0;
  double large_width = 1.0;
  /// A remembered plane stays while this share of the view's depth lies on it...
  double min_support = 0.01;
  /// ... and is fitted anew to what does, as long as that turns and shifts it by less than this.
  double most_turn = 0.09;   ///< radians
  double most_shift = 0.04;  ///< metres
  /// Two planes nearer to each other than this are one.
  double same_turn = 0.17;   ///< radians
  double same_shift = 0.06;  ///< metres

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// The static planes (tables, floor, walls), remembered from frame to frame: while a person fills
/// the view too little of them is seen to find them.
class StaticPlanes {
 public:
  StaticPlanes(const StaticPlanesOptions& options, const PlaneOptions& planes)
      : options_(options), plane_options_(planes) {}

  void forget() { known_.clear(); }
  /// Takes the remembered planes along with the camera. To be called once for every frame.
  void move(const Se3& current_from_previous);
  /// The planes found in the last frame and the remembered ones, camera frame.
  std::vector<Plane> planes() const;
  /// Of these the ones that have been there for long enough; where none has, all of them.
  std::vector<Plane> surest() const;
  /// Takes the planes that were found in a frame, drops those that are forgotten or not seen in the
  /// view, and adapts the others to it. `time` in seconds.
  void update(const DepthView& view, const std::vector<Plane>& found, double time);
  /// Finds planes in a frame outside `hidden`, and updates. One that lies in `people` more than
  /// elsewhere and runs on into `hidden` is none of the room: two backs side by side, a monitor and
  /// an arm. Both CV_8UC1 of the view's size, or empty. Where no plane has been known for long, one
  /// that is larger than people is of the room in any case, and where boxes alone are hidden
  /// (`people` is empty) it is looked for in them, too.
  void look(const DepthView& view, const cv::Mat& hidden, const cv::Mat& people, double time,
            std::uint64_t seed);
  const PlaneOptions& plane_options() const { return plane_options_; }

 private:
  struct Known {
    Plane plane;
    double first_found = 0.0, last_found = 0.0;  ///< seconds
    bool large = false;                          ///< was seen to be too large for anybody
  };
  bool is_same(const Plane& a, const Plane& b) const;
  bool is_among(const std::vector<Plane>& planes, const Plane& plane) const;
  bool is_large(const Plane& plane) const;
  bool is_proved(const Known& known) const;
  bool none_proved() const;
  bool runs_through_people(const DepthView& view, const cv::Mat& silhouettes, const cv::Mat& people,
                           const Plane& plane) const;
  bool adapt(const DepthView& view, Plane& plane) const;
  void add_largest(const DepthView& view, std::uint64_t seed, std::vector<Plane>& found) const;

  StaticPlanesOptions options_;
  PlaneOptions plane_options_;
  std::vector<Known> known_;
  double time_ = 0.0;  ///< of the last frame, seconds
};

}  // namespace dkp_slam
