#include "viewer/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/class_table.h"
#include "dkp_slam/sensor/jpeg_codec.h"
#include "viewer/container.h"

namespace dkp_slam::viewer {
namespace {

double rounded(double share) { return std::round(share * 1e4) / 1e4; }

nlohmann::json objects_json(const FrameSnapshot& snapshot, const cv::Size& size) {
  nlohmann::json list = nlohmann::json::array();
  for (const DynamicObject& o : snapshot.dynamics.objects) {
    list.push_back({{"id", o.id},
                    {"name", ClassTable::name(o.class_id)},
                    {"box",
                     {rounded(o.box.x / size.width), rounded(o.box.y / size.height),
                      rounded(o.box.width / size.width), rounded(o.box.height / size.height)}},
                    {"score", rounded(o.score)},
                    {"carried", o.compensated}});
  }
  return list;
}

nlohmann::json outlines_json(const cv::Mat& mask) {
  nlohmann::json list = nlohmann::json::array();
  if (mask.empty()) return list;
  constexpr double most_off = 1.0;     // pixels, of the simplified outline
  constexpr double least_area = 30.0;  // pixels
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask.clone(), outlines, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  for (const std::vector<cv::Point>& outline : outlines) {
    if (cv::contourArea(outline) < least_area) continue;
    std::vector<cv::Point> simple;
    cv::approxPolyDP(outline, simple, most_off, true);
    nlohmann::json points = nlohmann::json::array();
    for (const cv::Point& p : simple) {
      points.push_back(rounded((p.x + 0.5) / mask.cols));
      points.push_back(rounded((p.y + 0.5) / mask.rows));
    }
    list.push_back(std::move(points));
  }
  return list;
}

std::uint16_t in_65535ths(float pixel, int size) {
  return static_cast<std::uint16_t>(
      std::clamp(std::lround((pixel + 0.5) / size * 65535.0), 0L, 65535L));
}

std::vector<std::uint16_t> feature_numbers(const FrameSnapshot& snapshot, const cv::Size& size) {
  std::vector<FeatureDynamics> verdicts = snapshot.dynamics.features;
  verdicts.resize(snapshot.keypoints.size());
  std::vector<std::uint16_t> numbers;
  numbers.reserve(3 * verdicts.size());
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const cv::Point2f& at = snapshot.keypoints[i].pt;
    const bool landmark = i < snapshot.landmarks.size() && snapshot.landmarks[i] >= 0;
    numbers.push_back(in_65535ths(at.x, size.width));
    numbers.push_back(in_65535ths(at.y, size.height));
    numbers.push_back(static_cast<std::uint16_t>(static_cast<unsigned>(verdicts[i].region) |
                                                 (verdicts[i].is_static ? 4U : 0U) |
                                                 (landmark ? 8U : 0U)));
  }
  return numbers;
}

}  // namespace

std::string encode_picture(const FrameSnapshot& snapshot, int most_width, int quality) {
  const cv::Size size = snapshot.frame.colour.size();
  cv::Mat small = snapshot.frame.colour;
  if (size.width > most_width) {
    const double factor = static_cast<double>(most_width) / size.width;
    cv::resize(snapshot.frame.colour, small, {}, factor, factor, cv::INTER_AREA);
  }
  const std::vector<unsigned char> jpeg = encode_jpeg(small, quality);
  Container container;
  container.add("features", feature_numbers(snapshot, size));
  container.add("jpeg", jpeg);
  return container.finish({{"frame", snapshot.frame.index},
                           {"time", snapshot.frame.timestamp},
                           {"width", small.cols},
                           {"height", small.rows},
                           {"full_width", size.width},
                           {"full_height", size.height},
                           {"objects", objects_json(snapshot, size)},
                           {"mask", outlines_json(snapshot.dynamics.mask)}});
}

void PictureStore::offer(std::shared_ptr<const FrameSnapshot> snapshot) {
  const std::lock_guard lock(mutex_);
  offered_ = std::move(snapshot);
}

PictureStore::Picture PictureStore::newest() {
  const std::lock_guard one_at_a_time(making_);
  std::shared_ptr<const FrameSnapshot> snapshot;
  {
    const std::lock_guard lock(mutex_);
    if (!offered_) return nullptr;
    const auto& kept = kept_.entries();
    const bool young = std::chrono::steady_clock::now() - made_ < least_age;
    if (!kept.empty() && (young || kept.back().frame >= offered_->frame.index))
      return kept.back().value;
    snapshot = offered_;
  }
  auto picture = std::make_shared<const std::string>(encode_picture(*snapshot));
  const std::lock_guard lock(mutex_);
  made_ = std::chrono::steady_clock::now();
  kept_.add(snapshot->frame.index, picture, picture->size());
  return picture;
}

PictureStore::Picture PictureStore::at(int frame) {
  const std::lock_guard lock(mutex_);
  const auto* found = kept_.at(frame);
  return found ? found->value : nullptr;
}

std::size_t PictureStore::pictures() const {
  const std::lock_guard lock(mutex_);
  return kept_.entries().size();
}

}  // namespace dkp_slam::viewer
