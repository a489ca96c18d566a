#include "dkp_slam/detection/motion/motion_detector.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/geometry/planes/depth_view.h"

namespace dkp_slam {
namespace {

const Camera& checked(const Camera& camera) {
  if (const auto problem = camera.check()) throw Error("camera '" + camera.name + "': " + *problem);
  return camera;
}

}  // namespace

MotionDetector::MotionDetector(const Camera& camera, const MotionDetectorOptions& options)
    : camera_(checked(camera)),
      options_(options),
      grid_(camera, options.columns),
      ego_(camera, options.ego),
      background_(grid_, camera, options.background),
      evidence_(grid_, options.evidence),
      planes_(options.static_planes, options.planes),
      rays_(depth_view_rays(camera_)) {
  restart();
}

void MotionDetector::restart() {
  past_.clear();
  background_.clear();
  planes_.forget();
  log_odds_ = cv::Mat::zeros(grid_.size(), CV_32FC1);
  standing_ = cv::Mat::zeros(grid_.size(), CV_32FC1);
  moving_ = cv::Mat::zeros(grid_.size(), CV_8UC1);
  on_planes_ = cv::Mat::zeros(grid_.size(), CV_8UC1);
}

// Of somebody who fills the view just now a detector that knows nothing would make the room.
void MotionDetector::go_on_without_motion(const CoarseView& view) {
  const cv::Mat before = past_.back().view.depth;
  past_.clear();
  background_.clear();
  standing_.setTo(0.0);
  log_odds_.forEach<float>([&](float& log_odds, const int* at) {
    const float z = view.depth.at<float>(at[0], at[1]), z_before = before.at<float>(at[0], at[1]);
    const bool same = z > 0.0F && std::abs(z - z_before) < options_.keep_step * z;
    log_odds = same ? std::max(log_odds, 0.0F) : 0.0F;
  });
}

std::vector<Detection> MotionDetector::found(const cv::Size& image_size) const {
  cv::Mat moving = moving_.clone();
  moving.setTo(0, on_planes_ & (log_odds_ < options_.regions.seed));
  return motion_detections(moving, log_odds_, grid_, image_size, options_.regions);
}

void MotionDetector::check(const RgbdFrame& frame) const {
  const cv::Size size(camera_.width, camera_.height);
  if (frame.colour.size() != size || frame.colour.type() != CV_8UC3 || frame.depth.size() != size ||
      frame.depth.type() != CV_32FC1) {
    throw Error("the motion detector needs colour and depth images of the camera's size");
  }
}

const MotionDetector::Past& MotionDetector::flow_partner(double timestamp) const {
  // The newest one that is far enough back; the list runs from old to new.
  const auto near = std::find_if(past_.rbegin(), past_.rend(), [&](const Past& past) {
    return timestamp - past.timestamp >= options_.flow_interval;
  });
  return near == past_.rend() ? past_.front() : *near;
}

std::vector<Detection> MotionDetector::detect(const RgbdFrame& frame) {
  check(frame);
  cv::Mat grey;
  cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
  CoarseView view = grid_.view(grey, frame.depth);
  const double seconds = past_.empty() ? 0.0 : frame.timestamp - past_.back().timestamp;
  const EgoMotion motion = ego_.update(grey, frame.depth, trust(), seconds);
  if (seconds <= 0.0 || seconds > options_.max_gap) {
    restart();
  } else if (!motion.valid) {
    go_on_without_motion(view);
  } else {
    view.rows = RowMotion(camera_.readout, motion.velocity);
    past_.back().view.rows = RowMotion(camera_.readout, motion.previous_velocity);
  }
  find_planes(frame, motion.current_from_previous);

  const cv::Mat none = cv::Mat::zeros(grid_.size(), CV_8UC1);
  if (past_.empty()) {
    moving_ = grow_motion(log_odds_, view.depth, grid_, options_.regions);
    background_.update(view, none, moving_, none);
    past_.push_back({frame.timestamp, view, Se3()});
    return found(frame.colour.size());
  }
  for (Past& past : past_) {
    past.current_from_past = motion.current_from_previous * past.current_from_past;
  }
  const Past& partner = flow_partner(frame.timestamp);
  const MotionEvidence evidence = find_evidence(view, partner);
  carry(view, evidence.flow, static_cast<float>(seconds / (frame.timestamp - partner.timestamp)),
        seconds);
  background_.move(motion.current_from_previous, view.rows);
  const cv::Mat depth_evidence = background_.compare(view.depth);
  gather(view, depth_evidence, evidence, seconds);
  moving_ = grow_motion(log_odds_, view.depth, grid_, options_.regions);

  const cv::Mat absorb = standing_ > options_.absorb_after;
  background_.update(view, depth_evidence, moving_, absorb);
  standing_.setTo(0.0, absorb);
  log_odds_.setTo(-1.0, absorb);
  past_.push_back({frame.timestamp, view, Se3()});
  while (past_.size() > 2 && frame.timestamp - past_[1].timestamp >= options_.flow_interval) {
    past_.pop_front();
  }
  return found(frame.colour.size());
}

MotionEvidence MotionDetector::find_evidence(const CoarseView& view, const Past& partner) const {
  MotionEvidence evidence = evidence_.find(view, partner.view, partner.current_from_past.inverse());
  const Past& newest = past_.back();
  if (&partner != &newest)
    evidence_.add_newer(view, newest.view, newest.current_from_past.inverse(), evidence);
  return evidence;
}

void MotionDetector::find_planes(const RgbdFrame& frame, const Se3& current_from_previous) {
  constexpr std::uint64_t seed = 1;  // the same image has the same planes
  const DepthView view = make_depth_view(frame.depth, rays_);
  planes_.move(current_from_previous);
  planes_.look(view, {}, {}, frame.timestamp, seed);
  const std::vector<Plane> planes = planes_.surest();
  const int step = grid_.step(), half = step / 2;
  for (int v = 0; v < on_planes_.rows; ++v) {
    for (int u = 0; u < on_planes_.cols; ++u) {
      const cv::Point centre(u * step + half, v * step + half);
      const bool on = runs_along_any(view, planes, centre, options_.planes);
      on_planes_.at<uchar>(v, u) = on ? 255 : 0;
    }
  }
}

cv::Mat MotionDetector::trust() const {
  cv::Mat trust(grid_.size(), CV_32FC1);
  for (int i = 0; i < grid_.size().area(); ++i) {
    const int u = i % trust.cols, v = i / trust.cols;
    const float known = std::min(1.0F, static_cast<float>(background_.age(i)) / options_.known_age);
    float& out = trust.at<float>(v, u);
    out = 0.05F + 0.95F * known;
    if (on_planes_.at<uchar>(v, u)) {
      out = 1.0F;
    } else if (log_odds_.at<float>(v, u) > 0.0F) {
      out *= 0.2F;
    }
    if (moving_.at<uchar>(v, u)) out = 0.001F;  // a last resort where nothing else is left
  }
  return trust;
}

void MotionDetector::carry(const CoarseView& view, const cv::Mat& flow, float share,
                           double seconds) {
  const cv::Size size = grid_.size();
  cv::Mat log_odds = cv::Mat::zeros(size, CV_32FC1), standing = cv::Mat::zeros(size, CV_32FC1);
  const auto fade = static_cast<float>(std::exp(-seconds / options_.memory));
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec2f back = share * flow.at<cv::Vec2f>(v, u);
      const int x = cvRound(u + back[0]), y = cvRound(v + back[1]);
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      // Flow is smooth over the edges of objects: what it drags onto another surface stays behind,
      // also by way of the cells without depth along the edge.
      const float z = view.depth.at<float>(v, u), source = past_.back().view.depth.at<float>(y, x);
      if (z > 0.0F && std::abs(z - source) > options_.carry_step * z) continue;
      const float before = log_odds_.at<float>(y, x);
      log_odds.at<float>(v, u) = before > 0.0F ? fade * before : before;
      standing.at<float>(v, u) = standing_.at<float>(y, x);
    }
  }
  log_odds_ = log_odds;
  standing_ = standing;
}

void MotionDetector::gather(const CoarseView& view, const cv::Mat& depth_evidence,
                            const MotionEvidence& motion, double seconds) {
  const auto is = [](uchar value, DepthEvidence evidence) {
    return value == static_cast<uchar>(evidence);
  };
  // Single cells and rims one cell wide are noise of the depth's edges.
  cv::Mat came = (depth_evidence == static_cast<int>(DepthEvidence::nearer)) | motion.came;
  cv::morphologyEx(came, came, cv::MORPH_OPEN, cv::Mat());
  // Gains are per frame at 30 Hz; a late frame counts for at most two.
  const auto frames = static_cast<float>(std::min(2.0, 30.0 * seconds));
  const cv::Size size = grid_.size();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (view.depth.at<float>(v, u) <= 0.0F) continue;
      float& log_odds = log_odds_.at<float>(v, u);
      float& standing = standing_.at<float>(v, u);
      const uchar depth = depth_evidence.at<uchar>(v, u);
      const schar vote = motion.vote.at<schar>(v, u);
      if (is(depth, DepthEvidence::farther)) {  // what stood before it has left
        log_odds = std::min(log_odds, -0.5F);
        standing = 0.0F;
        continue;
      }
      float change = vote > 0 ? options_.moving_gain : 0.0F;
      if (came.at<uchar>(v, u)) {
        change += options_.came_gain;
        standing = vote > 0 ? 0.0F : standing + static_cast<float>(seconds);
      } else {
        standing = 0.0F;
        if (vote < 0) change -= options_.static_gain;
        if (is(depth, DepthEvidence::consistent)) change -= options_.same_gain;
      }
      log_odds = std::clamp(log_odds + frames * change, -options_.limit, options_.limit);
    }
  }
}

}  // namespace dkp_slam
