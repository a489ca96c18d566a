#include "dkp_slam/geometry/coarse_rotation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam {
namespace {

constexpr int small_width = 80;         // pixels
constexpr double least_share = 0.1;     // of the small image that both frames must show
constexpr double blurs[] = {3.0, 1.5};  // sigma in small pixels, the coarser first
constexpr int iterations = 12;          // at each of them
constexpr double robust = 12.0;         // grey levels beyond which a difference counts less (Huber)

/// Between pixels, bilinear.
double at(const cv::Mat& image, double x, double y) {
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const double u = x - x0, v = y - y0;
  const auto* top = image.ptr<float>(y0) + x0;
  const auto* bottom = image.ptr<float>(y0 + 1) + x0;
  return (1.0 - v) * ((1.0 - u) * static_cast<double>(top[0]) + u * static_cast<double>(top[1])) +
         v * ((1.0 - u) * static_cast<double>(bottom[0]) + u * static_cast<double>(bottom[1]));
}

}  // namespace

CoarseRotation::Blurred CoarseRotation::blurred(const cv::Mat& grey, double sigma) {
  Blurred b;
  cv::GaussianBlur(grey, b.grey, {}, sigma, sigma, cv::BORDER_REFLECT_101);
  constexpr double sobel = 1.0 / 8.0;
  cv::Sobel(b.grey, b.dx, CV_32F, 1, 0, 3, sobel, 0.0, cv::BORDER_REFLECT_101);
  cv::Sobel(b.grey, b.dy, CV_32F, 0, 1, 3, sobel, 0.0, cv::BORDER_REFLECT_101);
  return b;
}

CoarseRotation::CoarseRotation(const Camera& camera)
    : size_(small_width, std::max(8, small_width * camera.height / camera.width)),
      scale_x_(static_cast<double>(size_.width) / camera.width),
      scale_y_(static_cast<double>(size_.height) / camera.height) {
  fx_ = scale_x_ * camera.fx;
  fy_ = scale_y_ * camera.fy;
  cx_ = scale_x_ * (camera.cx + 0.5) - 0.5;
  cy_ = scale_y_ * (camera.cy + 0.5) - 0.5;
}

void CoarseRotation::push(const cv::Mat& grey, const std::vector<cv::Rect2f>& hidden) {
  before_ = std::move(now_);
  now_ = {};
  cv::Mat small;
  cv::resize(grey, small, size_, 0.0, 0.0, cv::INTER_AREA);
  small.convertTo(now_.grey, CV_32F);
  now_.visible = cv::Mat(size_, CV_8UC1, cv::Scalar(255));
  for (const cv::Rect2f& box : hidden) {
    const cv::Rect area(
        cv::Point(static_cast<int>(std::floor(scale_x_ * static_cast<double>(box.x))),
                  static_cast<int>(std::floor(scale_y_ * static_cast<double>(box.y)))),
        cv::Point(static_cast<int>(std::ceil(scale_x_ * static_cast<double>(box.br().x))),
                  static_cast<int>(std::ceil(scale_y_ * static_cast<double>(box.br().y)))));
    now_.visible(area & cv::Rect(cv::Point(), size_)).setTo(0);
  }
}

/// One Gauss-Newton step of the sum of (previous - offset - current)^2 over what both frames show:
/// (turn, offset). Nothing when they show too little in common.
std::optional<Eigen::Vector4d> CoarseRotation::step(const Blurred& previous, const cv::Mat& current,
                                                    const Eigen::Quaterniond& rotation,
                                                    double offset) const {
  Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  int used = 0;
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      if (now_.visible.at<std::uint8_t>(y, x) == 0) continue;
      const Eigen::Vector3d q = r * Eigen::Vector3d((x - cx_) / fx_, (y - cy_) / fy_, 1.0);
      constexpr double least_z = 0.1;  // of a ray one long: the frame before does not see it
      if (q.z() < least_z) continue;
      const double iz = 1.0 / q.z();
      const double u = fx_ * q.x() * iz + cx_, v = fy_ * q.y() * iz + cy_;
      if (u < 0.0 || v < 0.0 || u >= size_.width - 1 || v >= size_.height - 1) continue;
      if (before_.visible.at<std::uint8_t>(cvRound(v), cvRound(u)) == 0) continue;
      ++used;
      const double error =
          at(previous.grey, u, v) - offset - static_cast<double>(current.at<float>(y, x));
      const double gx = fx_ * iz * at(previous.dx, u, v);
      const double gy = fy_ * iz * at(previous.dy, u, v);
      const Eigen::Vector3d by_point(gx, gy, -(gx * q.x() + gy * q.y()) * iz);
      Eigen::Vector4d j;
      j << q.cross(by_point), -1.0;
      const double weight = std::min(1.0, robust / std::max(1e-9, std::abs(error)));
      hessian.noalias() += weight * j * j.transpose();
      gradient.noalias() += weight * error * j;
    }
  }
  if (used < least_share * size_.area()) return std::nullopt;
  hessian.diagonal().array() += 1e-6;
  const Eigen::Vector4d step = -hessian.ldlt().solve(gradient);
  return step.allFinite() ? std::optional(step) : std::nullopt;
}

std::optional<Eigen::Quaterniond> CoarseRotation::previous_from_current() const {
  if (before_.grey.empty()) return std::nullopt;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double offset = 0.0;  // grey levels by which exposure or lamps have changed
  for (const double sigma : blurs) {
    const cv::Mat current = blurred(now_.grey, sigma).grey;
    const Blurred previous = blurred(before_.grey, sigma);
    for (int i = 0; i < iterations; ++i) {
      const auto change = step(previous, current, rotation, offset);
      if (!change) return std::nullopt;
      Vector6d turn = Vector6d::Zero();
      turn.tail<3>() = change->head<3>();
      rotation = (Se3::exp(turn).rotation * rotation).normalized();
      offset += (*change)[3];
      constexpr double settled = 2e-4;  // radians: a hundredth of a small pixel
      if (change->head<3>().norm() < settled) break;
    }
  }
  return rotation;
}

}  // namespace dkp_slam
