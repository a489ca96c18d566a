#include "dkp_slam/synth/render/edge_marks.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace dkp_slam {
namespace {

constexpr float facet_cosine = 0.85F;  // triangles of one surface that meet at a sharper edge
constexpr float facet_slope = 0.5F;    // or lie this far off each other's plane are an edge
constexpr float moving = 2.0F;         // pixels
// Of the brighter side: what lies beside each other with less is no edge to the eye or to a corner
// detector, and half a pixel's share of it is less than the sensor's noise.
constexpr float least_contrast = 0.05F;

bool differ(const cv::Vec3f& a, const cv::Vec3f& b) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > least_contrast * std::max(a[c], b[c])) return true;
  }
  return false;
}

void raise(std::uint8_t* value, std::uint8_t least) {
  const std::atomic_ref<std::uint8_t> shared(*value);
  std::uint8_t now = shared.load(std::memory_order_relaxed);
  while (now < least && !shared.compare_exchange_weak(now, least, std::memory_order_relaxed)) {
  }
}

}  // namespace

bool is_edge(const SeenPoint& a, const SeenPoint& b) {
  if (a.surface != b.surface) return true;
  if (a.surface < 0 || a.triangle == b.triangle) return false;
  const Eigen::Vector3f between = b.point - a.point;
  const float off = a.normal.dot(between);
  return std::abs(a.normal.dot(b.normal)) < facet_cosine ||
         off * off > facet_slope * facet_slope * between.squaredNorm();
}

EdgeMarks::EdgeMarks(cv::Size image, int samples, cv::Mat* memory)
    : samples_(samples), marks_(*memory) {
  marks_.create(image, CV_8UC1);
  marks_.setTo(1);
}

void EdgeMarks::mark_row(int y, const std::vector<SeenPoint>& seen, const cv::Mat& radiance) {
  const SeenPoint* here = seen.data() + static_cast<std::ptrdiff_t>(y) * marks_.cols;
  const auto mark_between = [&](int x, int bx, int by) {
    const SeenPoint &a = here[x], &b = here[(by - y) * marks_.cols + bx];
    if (!is_edge(a, b)) return;
    // What moves passes before more than it does in the middle of the exposure.
    const bool moves = std::max(a.motion.squaredNorm(), b.motion.squaredNorm()) > moving * moving;
    if (!moves && !differ(radiance.at<cv::Vec3f>(y, x), radiance.at<cv::Vec3f>(by, bx))) return;
    mark(x, y, a.motion);
    mark(bx, by, b.motion);
  };
  for (int x = 0; x < marks_.cols; ++x) {
    if (x + 1 < marks_.cols) mark_between(x, x + 1, y);
    if (y + 1 < marks_.rows) mark_between(x, x, y + 1);
  }
}

void EdgeMarks::mark(int x, int y, const Eigen::Vector2f& motion) {
  // What comes from behind the camera's plane may seem to move without bound.
  constexpr float farthest = 64.0F;
  const float length = std::min(motion.norm(), farthest);
  const int samples =
      std::clamp(static_cast<int>(std::ceil(length)), samples_, std::max(samples_, most_samples));
  // Half a pixel of the way to either side ends within the two pixels that meet at the edge.
  const float spread = std::max(length - 1.0F, 0.0F);
  const int steps = static_cast<int>(std::ceil(spread));
  for (int i = 0; i <= steps; ++i) {
    const float along =
        steps == 0 ? 0.0F : static_cast<float>(i) / static_cast<float>(steps) - 0.5F;
    const float share = motion.norm() > 0.0F ? along * spread / motion.norm() : 0.0F;
    const int at_x = x + cvRound(share * motion.x()), at_y = y + cvRound(share * motion.y());
    if (at_x < 0 || at_y < 0 || at_x >= marks_.cols || at_y >= marks_.rows) continue;
    raise(marks_.ptr<std::uint8_t>(at_y) + at_x, static_cast<std::uint8_t>(samples));
  }
}

}  // namespace dkp_slam
