#include "dkp_slam/feature/orb_extractor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <tuple>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dkp_slam {
namespace {

constexpr int patch_radius = 15;  // pixels of a level, of the orientation and descriptor patch
constexpr int border = 16;        // pixels of a level without corners: the patch must fit
constexpr int cell_size = 35;     // pixels of a level; a cell without a corner is searched again

std::vector<int> circle_rows(int radius) {
  std::vector<int> half_width(static_cast<std::size_t>(radius) + 1);
  for (int v = 0; v <= radius; ++v) {
    half_width[static_cast<std::size_t>(v)] =
        static_cast<int>(std::lround(std::sqrt(double(radius * radius - v * v))));
  }
  return half_width;
}

/// Corners of the cells of `image` that `found` leaves empty, at the lower threshold.
void search_empty_cells(const cv::Mat& image, int threshold, std::vector<cv::KeyPoint>& found) {
  const int columns = std::max(1, image.cols / cell_size);
  const int rows = std::max(1, image.rows / cell_size);
  std::vector<char> filled(static_cast<std::size_t>(columns * rows), 0);
  const auto cell_of = [&](const cv::Point2f& p) {
    const int c = std::min(columns - 1, static_cast<int>(p.x) * columns / image.cols);
    const int r = std::min(rows - 1, static_cast<int>(p.y) * rows / image.rows);
    return static_cast<std::size_t>(r * columns + c);
  };
  for (const cv::KeyPoint& k : found) filled[cell_of(k.pt)] = 1;
  std::vector<cv::KeyPoint> weak;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      if (filled[static_cast<std::size_t>(r * columns + c)]) continue;
      // FAST needs three pixels around a corner: cells overlap by that.
      const cv::Rect cell =
          cv::Rect(cv::Point(c * image.cols / columns - 3, r * image.rows / rows - 3),
                   cv::Point((c + 1) * image.cols / columns + 3, (r + 1) * image.rows / rows + 3)) &
          cv::Rect(0, 0, image.cols, image.rows);
      cv::FAST(image(cell), weak, threshold, true);
      for (cv::KeyPoint& k : weak) {
        k.pt += cv::Point2f(cell.tl());
        found.push_back(k);
      }
    }
  }
}

/// Of a level's image: where corners may lie, and the three pixels that FAST itself skips around.
cv::Rect inner_part(const cv::Size& image) {
  return {border - 3, border - 3, image.width - 2 * border + 6, image.height - 2 * border + 6};
}

/// The part of a level's image that the descriptors of these corners depend on.
cv::Rect described_part(const std::vector<cv::KeyPoint>& corners, const cv::Size& image) {
  constexpr int reach = 24;  // pixels: a turned patch, blurred
  cv::Point low(image.width, image.height), high(0, 0);
  for (const cv::KeyPoint& k : corners) {
    const cv::Point at(cvRound(k.pt.x), cvRound(k.pt.y));
    low = {std::min(low.x, at.x - reach), std::min(low.y, at.y - reach)};
    high = {std::max(high.x, at.x + reach), std::max(high.y, at.y + reach)};
  }
  return cv::Rect(low, high) & cv::Rect({0, 0}, image);
}

void append(const OrbFeatures& more, OrbFeatures& all) {
  all.keypoints.insert(all.keypoints.end(), more.keypoints.begin(), more.keypoints.end());
  all.descriptors.insert(all.descriptors.end(), more.descriptors.begin(), more.descriptors.end());
}

/// Levels of an image, each made from the one below when it is first asked for: whoever works on
/// the image itself need not wait for them. Safe to use from several threads.
class Pyramid {
 public:
  Pyramid(const cv::Mat& image, std::vector<cv::Size> sizes)
      : sizes_(std::move(sizes)), levels_(sizes_.size()), made_(sizes_.size()) {
    levels_.front() = image;
  }

  int levels() const { return static_cast<int>(levels_.size()); }

  const cv::Mat& level(int n) {
    const auto l = static_cast<std::size_t>(n);
    if (n == 0) return levels_.front();
    std::call_once(
        made_[l], [&] { cv::resize(level(n - 1), levels_[l], sizes_[l], 0, 0, cv::INTER_LINEAR); });
    return levels_[l];
  }

  /// All of them, once nobody asks any more.
  std::vector<cv::Mat> take() {
    for (int l = 0; l < levels(); ++l) level(l);
    return std::move(levels_);
  }

 private:
  std::vector<cv::Size> sizes_;
  std::vector<cv::Mat> levels_;
  std::vector<std::once_flag> made_;
};

/// What `of_level` makes of each level. They have nothing to do with each other, and are done in
/// several threads at once: whoever waits for a frame gets it sooner.
template <typename OfLevel>
std::vector<OrbFeatures> each_level(int count, const OfLevel& of_level) {
  std::vector<OrbFeatures> levels(static_cast<std::size_t>(count));
  cv::parallel_for_(cv::Range(0, count), [&](const cv::Range& range) {
    for (int l = range.start; l < range.end; ++l) levels[static_cast<std::size_t>(l)] = of_level(l);
  });
  return levels;
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options)
    : options_(options), patch_row_half_width_(circle_rows(patch_radius)) {
  const double inverse = 1.0 / options.scale;
  double share = options.features * (1.0 - inverse) / (1.0 - std::pow(inverse, options.levels));
  float scale = 1.0F;
  for (int level = 0; level < options.levels; ++level) {
    scales_.push_back(scale);
    wanted_per_level_.push_back(static_cast<int>(std::lround(share)));
    scale *= options.scale;
    share *= inverse;
    describers_.push_back(cv::ORB::create(options.features, options.scale, 1, border, 0, 2,
                                          cv::ORB::HARRIS_SCORE, 2 * patch_radius + 1));
  }
}

cv::Mat OrbExtractor::ground_of(const cv::Mat& grey) const {
  CV_Assert(grey.type() == CV_8UC1);
  const double enlargement = options_.enlargement;
  if (enlargement <= 1.0) return grey;
  cv::Mat ground;
  cv::resize(grey, ground, {}, enlargement, enlargement, cv::INTER_LINEAR);
  return ground;
}

std::vector<cv::Size> OrbExtractor::level_sizes(const cv::Size& ground) const {
  std::vector<cv::Size> sizes{ground};
  for (int level = 1; level < options_.levels; ++level) {
    const float scale = scales_[static_cast<std::size_t>(level)];
    const cv::Size size(cvRound(ground.width / scale), cvRound(ground.height / scale));
    if (size.width <= 2 * border || size.height <= 2 * border) break;
    sizes.push_back(size);
  }
  return sizes;
}

OrbFeatures OrbExtractor::extract(const cv::Mat& grey) const {
  const cv::Mat ground = ground_of(grey);
  Pyramid pyramid(ground, level_sizes(ground.size()));
  std::vector<OrbFeatures> levels = each_level(pyramid.levels(), [&](int level) {
    const cv::Mat& image = pyramid.level(level);
    if (image.cols <= 2 * border || image.rows <= 2 * border) return OrbFeatures();
    std::vector<cv::KeyPoint> corners = find_corners(image);
    OrbFeatures features = describe(image, spread(corners, image.size(), level), level);
    features.corners.push_back(std::move(corners));
    return features;
  });
  OrbFeatures out;
  for (OrbFeatures& f : levels) {
    append(f, out);
    out.corners.push_back(f.corners.empty() ? std::vector<cv::KeyPoint>()
                                            : std::move(f.corners.front()));
  }
  out.levels = pyramid.take();
  return out;
}

OrbFeatures OrbExtractor::extract_more(const OrbFeatures& found, const cv::Mat& allowed) const {
  std::vector<std::tuple<int, float, float>> known;
  known.reserve(found.keypoints.size());
  for (const cv::KeyPoint& k : found.keypoints) known.emplace_back(k.octave, k.pt.x, k.pt.y);
  std::sort(known.begin(), known.end());
  OrbFeatures out;
  const auto of_level = [&](int level) {
    const cv::Mat& image = found.levels[static_cast<std::size_t>(level)];
    std::vector<cv::KeyPoint> corners = found.corners[static_cast<std::size_t>(level)];
    const float to_x = static_cast<float>(allowed.cols) / static_cast<float>(image.cols);
    const float to_y = static_cast<float>(allowed.rows) / static_cast<float>(image.rows);
    std::erase_if(corners, [&](const cv::KeyPoint& k) {
      return allowed.at<uchar>(static_cast<int>(k.pt.y * to_y), static_cast<int>(k.pt.x * to_x)) ==
             0;
    });
    if (corners.empty()) return OrbFeatures();
    corners = spread(corners, image.size(), level);
    std::erase_if(corners, [&](const cv::KeyPoint& k) {
      const cv::Point2f pixel = image_pixel(k.pt, level);
      return std::binary_search(known.begin(), known.end(), std::tuple(level, pixel.x, pixel.y));
    });
    return corners.empty() ? OrbFeatures() : describe(image, std::move(corners), level);
  };
  const int levels = static_cast<int>(std::min(found.levels.size(), found.corners.size()));
  for (const OrbFeatures& f : each_level(levels, of_level)) append(f, out);
  return out;
}

cv::Point2f OrbExtractor::image_pixel(const cv::Point2f& corner, int level) const {
  const cv::Point2f ground = corner * scales_[static_cast<std::size_t>(level)];
  if (options_.enlargement <= 1.0) return ground;
  // Pixel centres have whole coordinates, so that both images begin at -0.5.
  const cv::Point2f half(0.5F, 0.5F);
  return static_cast<float>(1.0 / options_.enlargement) * (ground + half) - half;
}

OrbFeatures OrbExtractor::describe(const cv::Mat& image, std::vector<cv::KeyPoint> corners,
                                   int level) const {
  const auto l = static_cast<std::size_t>(level);
  add_angles(image, corners);
  // One level at a time on our own pyramid: OpenCV would build its own again, the slow exact way.
  // It blurs all that it is given.
  const cv::Rect part = described_part(corners, image.size());
  for (cv::KeyPoint& k : corners) k.pt -= cv::Point2f(part.tl());
  cv::Mat rows;
  describers_[l]->compute(image(part), corners, rows);
  for (cv::KeyPoint& k : corners) k.pt += cv::Point2f(part.tl());
  OrbFeatures out;
  out.keypoints = std::move(corners);
  const auto size =
      static_cast<float>(scales_[l] * (2 * patch_radius + 1) / std::max(1.0, options_.enlargement));
  for (std::size_t i = 0; i < out.keypoints.size(); ++i) {
    cv::KeyPoint& k = out.keypoints[i];
    k.pt = image_pixel(k.pt, level);
    k.octave = level;
    k.size = size;
    out.descriptors.emplace_back();
    std::memcpy(out.descriptors.back().data(), rows.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  return out;
}

std::vector<cv::KeyPoint> OrbExtractor::find_corners(const cv::Mat& image) const {
  const cv::Rect inner = inner_part(image.size());
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image(inner), corners, options_.fast_threshold, true);
  search_empty_cells(image(inner), options_.fast_low_threshold, corners);
  for (cv::KeyPoint& k : corners) k.pt += cv::Point2f(inner.tl());
  return corners;
}

std::vector<cv::KeyPoint> OrbExtractor::spread(const std::vector<cv::KeyPoint>& corners,
                                               const cv::Size& image, int level) const {
  std::vector<cv::KeyPoint> best = spread_by_quadtree(
      corners, inner_part(image), wanted_per_level_[static_cast<std::size_t>(level)]);
  for (cv::KeyPoint& k : best) {
    k.octave = 0;
    k.size = 2 * patch_radius + 1;
  }
  return best;
}

void OrbExtractor::add_angles(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints) const {
  const auto step = static_cast<std::ptrdiff_t>(image.step1());
  for (cv::KeyPoint& k : keypoints) {
    const uchar* centre = image.ptr<uchar>(cvRound(k.pt.y)) + cvRound(k.pt.x);
    int m10 = 0, m01 = 0;
    for (int u = -patch_radius; u <= patch_radius; ++u) m10 += u * centre[u];
    for (int v = 1; v <= patch_radius; ++v) {
      const int half = patch_row_half_width_[static_cast<std::size_t>(v)];
      const uchar* above = centre - v * step;
      const uchar* below = centre + v * step;
      int difference = 0;
      for (int u = -half; u <= half; ++u) {
        difference += below[u] - above[u];
        m10 += u * (below[u] + above[u]);
      }
      m01 += v * difference;
    }
    k.angle = cv::fastAtan2(static_cast<float>(m01), static_cast<float>(m10));
  }
}

}  // namespace dkp_slam
