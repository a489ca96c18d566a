#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/dynamics/compensation/dynamic_object.h"
#include "dkp_slam/dynamics/compensation/motion_history.h"
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
  /// A carried object that was detected no more often than this gives way to a better detection
  /// whose mask lies mostly in its own.
  int few_sightings = 2;
  /// Objects of this weight and more move by themselves (people, animals). Only they are carried: a
  /// chair that the detector loses has lost nothing. Their features need no proof to be removed.
  float self_moving_weight = 8.0F;
  bool compensate = true;  ///< false: no carrying, no weak continuation
  /// Seconds: answers about images longer ago than this tell nothing about now.
  double longest_delay = 1.0;

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
    int sightings = 0;  ///< detections of it
    double last_confirmed = 0.0;  ///< seconds: detected, or seen to move
    /// The newest answer of the detector did not hold it (true for what no detector ever saw): a
    /// verdict, which having no answer is not.
    bool missed = false;
    /// Where it was in an earlier frame.
    struct Past {
      double time = 0.0;  ///< seconds
      cv::Rect2f box;     ///< clipped to the image
    };
    std::deque<Past> past;    ///< the oldest first, over `longest_delay`
    cv::Size2f seen_size;     ///< of the box when it was last detected, pixels
    float seen_depth = 0.0F;  ///< T at that time, metres; 0 for unknown
  };

  /// Objects after the newest frame, in the order of their id.
  const std::vector<Tracked>& objects() const { return objects_; }
  /// Boxes of those that move by themselves.
  std::vector<cv::Rect2f> self_moving_boxes() const;
  /// What people hide, CV_8UC1 of the view's size; empty where there is nobody.
  struct Cover {
    /// Where static planes must not be looked for: the boxes of what moves by itself, or only its
    /// earlier silhouettes moved along when the boxes leave too little.
    cv::Mat hidden;
    /// In the latter case the silhouettes' hulls: a hole in one is no window to the room.
    cv::Mat people;
  };
  Cover cover(const cv::Size& view_size) const;
  /// What the mask cutter is to know of an object.
  static ObjectPrior prior_of(const Tracked& tracked);
  bool carries() const { return options_.compensate; }
  /// Objects that move by themselves and were dropped in the newest frame, because the detector
  /// missed them and boxes are not carried, though they were not leaving the image.
  int dropped_by_a_miss() const { return dropped_by_a_miss_; }

  /// Takes the frame at `time` seconds with the detector's newest answer. `flow` holds, for each of
  /// `objects()`, the median flow (pixels since the frame before) of its dynamic points, or nothing
  /// where there were too few; the object's own velocity then stands in. Detections of weight 1 or
  /// less are ignored.
  ///
  /// An answer about an earlier image is compared with where objects were then; `history` carries
  /// what it saw to now (it stays where it was seen without one). Without an answer, or with one
  /// that was given before, objects live on and nothing is missed.
  void update(double time, const cv::Size& image, const DetectionResult& answer,
              const std::vector<std::optional<cv::Point2f>>& flow,
              const MotionHistory* history = nullptr);

  /// Takes over what the clustering found for `objects()[index]`: mask, T and R. A carried object
  /// gets the box around its mask; one that is seen to move lives on as if it had been detected.
  void set_mask(std::size_t index, const ObjectMask& mask, bool moving);
  /// Adds an object that no detector saw, by its moving silhouette.
  void add_moving(const ObjectMask& mask);
  /// Drops carried objects whose mask lies mostly in that of another one, and mistakes of the
  /// detector, which the next image shows to be.
  void drop_duplicates();
  /// Removes objects, for example carried ones in whose box nothing was found. One flag each.
  void remove(const std::vector<bool>& gone);

 private:
  /// A detection, and what it has become since its image.
  struct Sighting {
    const Detection* detection;
    MotionHistory::Carried now;
  };
  using Pair = std::tuple<float, std::size_t, std::size_t>;  // agreement, object, sighting

  void predict(double time, const cv::Size& image,
               const std::vector<std::optional<cv::Point2f>>& flow);
  std::vector<Pair> agreements(const std::vector<Sighting>& sightings, double image_time) const;
  void associate(const std::vector<Sighting>& sightings, double image_time, const cv::Size& image);
  cv::Rect2f with_mask(const cv::Rect2f& box, const Tracked& tracked) const;
  void take(const Detection& detection, const cv::Rect2f& box, double image_time,
            const cv::Size& image, Tracked& tracked) const;
  void drop_gone();
  bool leaving(const Tracked& tracked) const;
  bool is_gone(const Tracked& tracked) const;
  bool mistaken_for(const Tracked& tracked, const Tracked& other) const;

  ObjectTrackerOptions options_;
  std::vector<Tracked> objects_;
  double last_time_ = 0.0;
  double passed_ = 0.0;  ///< seconds from the frame before to this one
  double last_answer_ = -std::numeric_limits<double>::infinity();  ///< its image's time, seconds
  int dropped_by_a_miss_ = 0;
  int next_id_ = 1;
};

/// Intersection over union of two boxes.
float box_iou(const cv::Rect2f& a, const cv::Rect2f& b);

}  // namespace dkp_slam
