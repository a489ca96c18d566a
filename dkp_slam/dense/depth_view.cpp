#include "dkp_slam/dense/depth_view.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

constexpr float far_away = 1e6F;

void check_image(const cv::Mat& image, int type, const Camera& camera, const char* name,
                 const char* form) {
  if (image.type() == type && image.cols == camera.width && image.rows == camera.height) return;
  throw Error(
      fmt::format("{} image for the dense map must be {} of {} x {} pixels, as the camera's", name,
                  form, camera.width, camera.height));
}

}  // namespace

DepthViewer::DepthViewer(const Camera& camera, const DepthViewOptions& options)
    : camera_(camera), options_(options) {
  if (const auto problem = camera.check()) throw Error(*problem);
  if (!(options.max_range > camera.min_depth && options.max_range <= 100.0)) {
    throw Error(
        fmt::format("dense map: range {} m must be above the camera's {} m and at most 100 m",
                    options.max_range, camera.min_depth));
  }
  if (!(options.mask_margin >= 0.0 && options.mask_margin <= 0.2)) {
    throw Error("dense map: the masks' margin must be 0 to 0.2 of the image's width");
  }
  if (!(options.edge > 0.0)) throw Error("dense map: the depth edge must be above 0");
  if (camera.distortion.none()) return;
  map_x_.create(camera.height, camera.width, CV_32FC1);
  map_y_.create(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d raw = camera.distort({double(u), double(v)});
      map_x_.at<float>(v, u) = static_cast<float>(raw.x());
      map_y_.at<float>(v, u) = static_cast<float>(raw.y());
    }
  }
}

void DepthViewer::check(const RgbdFrame& frame) const {
  check_image(frame.depth, CV_32FC1, camera_, "the depth", "32-bit float");
  check_image(frame.colour, CV_8UC3, camera_, "the colour", "8-bit BGR");
  if (!frame.mask.empty()) check_image(frame.mask, CV_8UC1, camera_, "the mask", "8-bit grey");
}

void DepthViewer::split_depth(const RgbdFrame& frame, cv::Mat& still, cv::Mat& moving) const {
  if (map_x_.empty()) {
    still = frame.depth.clone();
  } else {
    // Nearest: between two depths there is none.
    cv::remap(frame.depth, still, map_x_, map_y_, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  }
  if (!frame.mask.empty()) {
    cv::Mat mask;  // the frame's own is somebody else's
    if (map_x_.empty()) {
      mask = frame.mask.clone();
    } else {
      cv::remap(frame.mask, mask, map_x_, map_y_, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
    }
    still.copyTo(moving, mask);
    const int margin = static_cast<int>(std::lround(options_.mask_margin * camera_.width));
    if (margin > 0) {
      cv::dilate(mask, mask,
                 cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * margin + 1, 2 * margin + 1}));
    }
    still.setTo(0.0F, mask);
  }
}

StaticView DepthViewer::view(const RgbdFrame& frame, const Se3& world_from_camera,
                             const Vector6d& velocity) const {
  check(frame);
  StaticView view;
  view.world_from_camera = world_from_camera;
  view.velocity = velocity;
  if (map_x_.empty()) {
    view.colour = frame.colour;
  } else {
    cv::remap(frame.colour, view.colour, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  }
  cv::Mat depth;
  split_depth(frame, depth, view.moving);
  const cv::Mat unknown = depth <= 0.0F;
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8U);
  cv::Mat farthest;
  depth.copyTo(view.nearest);
  view.nearest.setTo(far_away, unknown);
  cv::erode(view.nearest, view.nearest, around);
  cv::dilate(depth, farthest, around);
  // Beyond the range depth still says that nothing is nearer.
  view.surface = depth;
  cv::Mat edge = (farthest - view.nearest) > options_.edge * depth;
  view.surface.setTo(0.0F, edge);
  view.surface.setTo(0.0F, view.surface > options_.max_range);
  view.nearest.setTo(0.0F, unknown);
  return view;
}

}  // namespace dkp_slam
