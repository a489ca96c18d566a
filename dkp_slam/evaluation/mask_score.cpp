#include "dkp_slam/evaluation/mask_score.h"

#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

void check_mask(const cv::Mat& mask, const char* name) {
  if (mask.type() != CV_8UC1) {
    throw Error(
        fmt::format("{} mask has OpenCV type {}; give 8-bit images of one channel (CV_8UC1)", name,
                    mask.type()));
  }
}

/// Pixels by true region (row) and estimated region (column), 0 being outside.
cv::Mat1i overlaps(const cv::Mat1i& truth, int truth_count, const cv::Mat1i& estimate,
                   int estimate_count) {
  cv::Mat1i counts(truth_count, estimate_count, 0);
  for (int v = 0; v < truth.rows; ++v) {
    const int* t = truth[v];
    const int* e = estimate[v];
    for (int u = 0; u < truth.cols; ++u) ++counts(t[u], e[u]);
  }
  return counts;
}

std::optional<double> share(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::vector<RegionScore> score_mask(const cv::Mat& truth, const cv::Mat& estimate,
                                    const MaskScoreOptions& options) {
  check_mask(truth, "true");
  const cv::Mat estimated = estimate.empty() ? cv::Mat::zeros(truth.size(), CV_8UC1) : estimate;
  check_mask(estimated, "estimated");
  if (estimated.size() != truth.size()) {
    throw Error(
        fmt::format("estimated mask has {} x {} pixels, true mask {} x {}; give masks of one size",
                    estimated.cols, estimated.rows, truth.cols, truth.rows));
  }
  cv::Mat1i truth_labels, estimate_labels;
  const int truth_count = cv::connectedComponents(truth != 0, truth_labels, 8, CV_32S);
  const int estimate_count = cv::connectedComponents(estimated != 0, estimate_labels, 8, CV_32S);
  const cv::Mat1i counts = overlaps(truth_labels, truth_count, estimate_labels, estimate_count);

  std::vector<RegionScore> scores;
  for (int t = 1; t < truth_count; ++t) {
    const double area = cv::sum(counts.row(t))[0];
    const double region_share = area / static_cast<double>(truth.total());
    if (region_share < options.min_region_share) continue;
    double covered = 0.0;
    double beyond = 0.0;  // estimated pixels, of regions that touch this one, outside all true ones
    for (int e = 1; e < estimate_count; ++e) {
      if (counts(t, e) == 0) continue;
      covered += counts(t, e);
      beyond += counts(0, e);
    }
    scores.push_back({region_share, covered / (area + beyond)});
  }
  return scores;
}

FeatureCounts count_features(const cv::Mat& truth, std::span<const cv::Point2f> positions,
                             const std::vector<bool>& kept) {
  check_mask(truth, "true");
  if (kept.size() != positions.size()) {
    throw Error(fmt::format("{} features but {} marks of what was kept; give one for each",
                            positions.size(), kept.size()));
  }
  const cv::Rect image(cv::Point(), truth.size());
  FeatureCounts counts;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const cv::Point pixel(static_cast<int>(std::lround(positions[i].x)),
                          static_cast<int>(std::lround(positions[i].y)));
    if (image.contains(pixel) && truth.at<uchar>(pixel) != 0) {
      ++counts.inside;
      if (!kept[i]) ++counts.inside_removed;
    } else {
      ++counts.outside;
      if (kept[i]) ++counts.outside_kept;
    }
  }
  return counts;
}

void MaskScoreTally::add(std::span<const RegionScore> regions, const FeatureCounts& features) {
  if (!regions.empty()) {
    double sum = 0.0;
    for (const RegionScore& region : regions) sum += region.iou;
    iou_sum_ += sum / static_cast<double>(regions.size());
    ++frames_;
  }
  features_.inside += features.inside;
  features_.inside_removed += features.inside_removed;
  features_.outside += features.outside;
  features_.outside_kept += features.outside_kept;
}

std::optional<double> MaskScoreTally::mean_iou() const {
  if (frames_ == 0) return std::nullopt;
  return iou_sum_ / static_cast<double>(frames_);
}

std::optional<double> MaskScoreTally::removed_share() const {
  return share(features_.inside_removed, features_.inside);
}

std::optional<double> MaskScoreTally::kept_share() const {
  return share(features_.outside_kept, features_.outside);
}

}  // namespace dkp_slam
