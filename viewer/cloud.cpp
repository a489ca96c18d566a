#include "viewer/cloud.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "viewer/container.h"

namespace dkp_slam::viewer {
namespace {

/// On both sides of an edge the sensor gives depths that lie between them.
bool at_edge(const cv::Mat& depth, int x, int y) {
  constexpr float share = 0.04F;  // of the depth, from one pixel to the next but one
  const float z = depth.at<float>(y, x);
  for (const auto& [dx, dy] : {std::pair{-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
    const float other = depth.at<float>(y + dy, x + dx);
    if (!(other > 0.0F) || std::abs(other - z) > share * z) return true;
  }
  return false;
}

}  // namespace

std::string make_cloud(const FrameSnapshot& snapshot, const Camera& camera, int step) {
  constexpr int border = 2;          // pixels, that at_edge looks beyond
  constexpr double farthest = 30.0;  // metres: 16 bits of millimetres
  const cv::Mat& depth = snapshot.frame.depth;
  const cv::Mat& mask = snapshot.dynamics.mask;
  std::vector<cv::Point2f> raw;
  for (int y = border; y < depth.rows - border; y += step) {
    for (int x = border; x < depth.cols - border; x += step) {
      const float z = depth.at<float>(y, x);
      if (!(z > 0.0F) || z > farthest || (!mask.empty() && mask.at<std::uint8_t>(y, x) != 0))
        continue;
      if (!at_edge(depth, x, y)) raw.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
  }
  std::vector<std::int16_t> positions;
  std::vector<std::uint8_t> colours;
  positions.reserve(3 * raw.size());
  colours.reserve(3 * raw.size());
  const std::vector<cv::Point2f> straight = camera.undistort(raw);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const cv::Point at(raw[i]);
    const Eigen::Vector3d point =
        camera.unproject({straight[i].x, straight[i].y}, depth.at<float>(at)) * 1e3;
    if (point.cwiseAbs().maxCoeff() > 32'000.0) continue;
    for (int c = 0; c < 3; ++c)
      positions.push_back(static_cast<std::int16_t>(std::lround(point[c])));
    const auto& bgr = snapshot.frame.colour.at<cv::Vec3b>(at);
    colours.insert(colours.end(), {bgr[2], bgr[1], bgr[0]});
  }
  Container container;
  container.add("positions", positions);
  container.add("colours", colours);
  return container.finish({{"frame", snapshot.frame.index}});
}

}  // namespace dkp_slam::viewer
