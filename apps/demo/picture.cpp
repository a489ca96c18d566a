#include <array>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "apps/demo/demo.h"
#include "dkp_slam/sensor/png_decoder.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam::apps {
namespace {

// Points. Larger than the picture, which is scaled down in the end: charts with their lettering are
// made for a page of about this size.
constexpr int width = 1080, height = 729;
constexpr double margin = 18.0;
constexpr double head_height = 58.0;
constexpr double cards_top = 72.0, cards_height = 62.0;
constexpr double charts_top = 146.0, charts_height = 292.0;
constexpr double frames_top = 468.0;
constexpr double frame_width = (width - 4.0 * margin) / 3.0;

constexpr Colour head_colour{22, 38, 58};
constexpr Colour white{255, 255, 255};
constexpr Colour pale{168, 188, 210};
constexpr Colour card_colour{240, 244, 248};
constexpr Colour dark{36, 41, 47};
constexpr Colour grey{96, 106, 116};

void draw_head(Canvas& canvas, const DemoResult& result) {
  canvas.rectangle({0.0, 0.0}, {static_cast<double>(width), head_height}, head_colour);
  canvas.text({margin, 38.0}, "dkp-slam", 26.0, TextAnchor::start, white);
  canvas.text({184.0, 37.0}, "a camera's path through a room where people walk about", 16.0,
              TextAnchor::start, pale);
  canvas.text({width - margin, 37.0},
              fmt::format("{}, seed {}, {} frames", result.scenario, result.options.seed,
                          result.best.frames),
              12.0, TextAnchor::end, pale);
}

void draw_card(Canvas& canvas, double left, double card_width, Colour colour,
               const std::string& figure, const std::string& what) {
  canvas.rectangle({left, cards_top}, {card_width, cards_height}, card_colour);
  canvas.rectangle({left, cards_top}, {6.0, cards_height}, colour);
  canvas.text({left + 18.0, cards_top + 31.0}, figure, 22.0, TextAnchor::start, dark);
  canvas.text({left + 18.0, cards_top + 51.0}, what, 11.5, TextAnchor::start, grey);
}

void draw_cards(Canvas& canvas, const DemoResult& result) {
  const double off = result.off.path.error.statistics.rmse;
  const double best = result.best.path.error.statistics.rmse;
  const double card_width = (width - 5.0 * margin) / 4.0;
  const auto left = [&](int i) { return margin + i * (card_width + margin); };
  draw_card(canvas, left(0), card_width, result.off.path.colour,
            fmt::format("{:.1f} mm", 1e3 * off), "error, mode off: nothing left out");
  draw_card(canvas, left(1), card_width, result.best.path.colour,
            fmt::format("{:.1f} mm", 1e3 * best), "error, mode dkp+: people left out");
  draw_card(canvas, left(2), card_width, {92, 156, 68},
            fmt::format("{:.0f} %", 100.0 * result.best.removed_share), "of the features removed");
  draw_card(canvas, left(3), card_width, {136, 86, 190}, result.yolox ? "YOLOX" : "motion",
            result.yolox ? "detector: " + result.model : "detector: needs no model");
}

void draw_charts(Canvas& canvas, const DemoResult& result) {
  const std::array<ScoredPath, 2> paths{result.off.path, result.best.path};
  const double chart_width = (width - 3.0 * margin) / 2.0;
  draw_paths_from_above(canvas, {{margin, charts_top}, {chart_width, charts_height}}, result.truth,
                        paths);
  draw_errors_over_time(
      canvas, {{2.0 * margin + chart_width, charts_top}, {chart_width, charts_height}}, paths);
}

void draw_frames(Canvas& canvas, const DemoResult& result) {
  if (result.frames.empty()) return;
  const DemoFrame& first = result.frames[result.frames.size() / 2];
  const DemoFrame& second = result.frames.front();
  const std::array<std::pair<const cv::Mat*, std::string>, 3> pictures{
      {{&first.off, fmt::format("frame {}, off: every feature is used", first.index)},
       {&first.best, fmt::format("the same, dkp+: x = removed", first.index)},
       {&second.best, fmt::format("frame {}, dkp+", second.index)}}};
  double left = margin;
  for (const auto& [picture, caption] : pictures) {
    canvas.text({left, frames_top - 8.0}, caption, 13.0, TextAnchor::start, dark);
    const double frame_height = frame_width * picture->rows / picture->cols;
    canvas.image({left, frames_top}, {frame_width, frame_height}, *picture);
    left += frame_width + margin;
  }
}

}  // namespace

std::string demo_picture(const DemoResult& result) {
  const auto canvas = png_canvas(width, height);
  draw_head(*canvas, result);
  draw_cards(*canvas, result);
  draw_charts(*canvas, result);
  draw_frames(*canvas, result);
  const std::string large = canvas->encode();
  cv::Mat page, small;
  std::string problem;
  PngDecoder().decode({reinterpret_cast<const std::uint8_t*>(large.data()), large.size()}, &page,
                      &problem);
  cv::resize(page, small, {demo_picture_width, demo_picture_height}, 0, 0, cv::INTER_AREA);
  const std::vector<std::uint8_t> png = encode_png(small, PngSize::small);
  return {png.begin(), png.end()};
}

}  // namespace dkp_slam::apps
