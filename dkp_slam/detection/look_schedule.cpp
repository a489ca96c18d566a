#include "dkp_slam/detection/look_schedule.h"

#include <opencv2/imgproc.hpp>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

constexpr double at_the_start = 1.0;     // seconds in which it looks at every image
constexpr float moves_by_itself = 8.0F;  // weight from which a class does: people and animals
constexpr float seen = 0.25F;            // score of somebody who counts

/// Share of the image in boxes of what moves by itself.
double covered(const std::vector<Detection>& detections, const cv::Size& image) {
  constexpr int cell = 8;  // pixels
  cv::Mat grid = cv::Mat::zeros(image.height / cell + 1, image.width / cell + 1, CV_8UC1);
  for (const Detection& d : detections) {
    if (d.weight < moves_by_itself || d.score < seen) continue;
    const cv::Rect2f box(d.box.tl() / cell, d.box.br() / cell);
    grid(cv::Rect(box) & cv::Rect({}, grid.size())).setTo(1);
  }
  return static_cast<double>(cv::countNonZero(grid)) / static_cast<double>(grid.total());
}

}  // namespace

void LookOptions::describe(OptionList& list) {
  list.add(
      "interval", interval, at_least(0), "seconds",
      "between two, at least, while people and animals cover less than 'many'; 0: every image");
  list.add("many", many, between(0, 1), "",
           "share of the image from which on it looks at every one");
  list.add(
      "nearer", nearer, between(0, 1), "",
      "share of the image that is nearer than all about it was in the one before, from which on it "
      "looks at once");
}

void LookOptions::check() const { check_options(*this); }

bool LookSchedule::due(double time, const cv::Mat& depth) {
  const bool startled = startle_.by(time, depth);
  if (!start_ || time < last_look_) {
    start_ = time;
  } else if (time - *start_ >= at_the_start && share_ < options_.many && !startled &&
             time - last_look_ < options_.interval) {
    return false;
  }
  last_look_ = time;
  return true;
}

void LookSchedule::saw(const std::vector<Detection>& detections, const cv::Size& image) {
  share_ = covered(detections, image);
}

}  // namespace dkp_slam
