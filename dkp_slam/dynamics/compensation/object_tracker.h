#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/dynamics/compensation/dynamic_object.h"
#include "dkp_slam/dynamics/masks/clustering.h"

namespace dkp_slam {

class OptionList;

struct ObjectTrackerOptions {
  float start_score = 0.3F;      ///< a new object needs this score
  float continue_score = 0.10F;  ///< a known one goes on with this, where the boxes agree
  float continue_iou = 0.3F;     ///< intersection over union by which they agree
  /// How long an object lives without a detection. YOLOX-nano misses torsos at the image border
  /// for more than a second at a time; half a second is measurably too short.
  double carry_seconds = 1.5;
  /// A carried object's sides may become this much longer than when it was seen, beside what its
  /// coming nearer explains: a mask that runs over into the wall behind would grow for ever.
  float carried_growth = 1.3F;
  /// A carried object that keeps less than this share of its box in the image has left.
  float leaving_share = 0.15F;
  /// Carried objects whose box lies in a detected one's by this share are the same person.
  float duplicate_share = 0.7F;
  /// Objects of this weight and more move by themselves (people, animals). Only they are carried: a
  /// chair that the detector loses has lost nothing. Their features need no proof to be removed.
  float self_moving_weight = 8.0F;
  bool compensate = true;  ///< false: no carrying, no weak continuation

  void describe(OptionList& list);
  void check() const;  ///< throws `Error`, which names field, value and bound
};

/// Missed-detection compensation (paper §3.3): known objects go on living where the detector
/// misses them, moved by the flow of their own dynamic points.
class ObjectTracker {
 public:
  explicit ObjectTracker(const ObjectTrackerOptions& options) : options_(options) {}

  /// An object of this frame with what its detection brought along.
  struct Tracked {
    DynamicObject object;
    cv::Rect2f whole_box;     ///< not clipped to the image
    cv::Point2f velocity;     ///< pixels a second
    cv::Mat silhouette;       ///< the detection's own mask, Detection::mask; empty for none
    cv::Rect2f detected_box;  ///< where `silhouette` lies
    ObjectMask mask;    ///< of the newest frame once `set_mask` was called, else of the one before
    cv::Point2f shift;  ///< pixels it moved since the frame before
    double last_confirmed = 0.0;  ///< seconds: detected, or seen to move
    cv::Size2f seen_size;         ///< of the box when it was last detected, pixels
    float seen_depth = 0.0F;      ///< T at that time, metres; 0 for unknown
  };

  /// Objects after the newest frame, in the order of their id.
  const std::vector<Tracked>& objects() const { return objects_; }
  /// Boxes of those that move by themselves.
  std::vector<cv::Rect2f> self_moving_boxes() const;
  /// Where static planes must not be looked for, CV_8UC1 of the view's size: the boxes of what
  /// moves by itself, or only its earlier silhouettes moved along when the boxes leave too little.
  /// Empty when there is nothing of the kind.
  cv::Mat cover(const cv::Size& view_size) const;
  /// What the mask cutter is to know of an object.
  static ObjectPrior prior_of(const Tracked& tracked);
  bool carries() const { return options_.compensate; }
  /// Objects that move by themselves and were dropped in the newest frame, because the detector
  /// missed them and boxes are not carried, though they were not leaving the image.
  int dropped_by_a_miss() const { return dropped_by_a_miss_; }

  /// Takes the detections of the frame at `time` seconds. `flow` holds, for each of `objects()`,
  /// the median flow (pixels since the frame before) of its dynamic points, or nothing where there
  /// were too few; the object's own velocity then stands in. Detections of weight 1 or less are
  /// ignored.
  void update(double time, const cv::Size& image, const std::vector<Detection>& detections,
              const std::vector<std::optional<cv::Point2f>>& flow);

  /// Takes over what the clustering found for `objects()[index]`: mask, T and R. A carried object
  /// gets the box around its mask; one that is seen to move lives on as if it had been detected.
  void set_mask(std::size_t index, const ObjectMask& mask, bool moving);
  /// Adds an object that no detector saw, by its moving silhouette.
  void add_moving(const ObjectMask& mask);
  /// Drops carried objects whose mask lies mostly in that of another one.
  void drop_duplicates();
  /// Removes objects, for example carried ones in whose box nothing was found. One flag each.
  void remove(const std::vector<bool>& gone);

 private:
  void predict(double dt, const cv::Size& image,
               const std::vector<std::optional<cv::Point2f>>& flow);
  bool leaving(const Tracked& tracked) const;
  bool is_gone(const Tracked& tracked) const;

  ObjectTrackerOptions options_;
  std::vector<Tracked> objects_;
  double last_time_ = 0.0;
  int dropped_by_a_miss_ = 0;
  int next_id_ = 1;
};

/// Intersection over union of two boxes.
float box_iou(const cv::Rect2f& a, const cv::Rect2f& b);

}  // namespace dkp_slam
