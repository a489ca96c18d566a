#include <array>
#include <utility>

#include <fmt/format.h>

#include "apps/demo/demo.h"

namespace dkp_slam::apps {
namespace {

// Points; the canvas draws two pixels to each.
constexpr int width = demo_picture_width / 2, height = demo_picture_height / 2;
constexpr double margin = 14.0;
constexpr double head_height = 46.0;
constexpr double cards_top = 56.0, cards_height = 50.0;
constexpr double charts_top = 112.0, charts_height = 212.0;
constexpr double frames_top = 346.0;
constexpr double frame_width = (width - 4.0 * margin) / 3.0;

constexpr Colour head_colour{22, 38, 58};
constexpr Colour white{255, 255, 255};
constexpr Colour pale{168, 188, 210};
constexpr Colour card_colour{240, 244, 248};
constexpr Colour dark{36, 41, 47};
constexpr Colour grey{96, 106, 116};

void draw_head(Canvas& canvas, const DemoResult& result) {
  canvas.rectangle({0.0, 0.0}, {static_cast<double>(width), head_height}, head_colour);
  canvas.text({margin, 29.0}, "dkp-slam", 21.0, TextAnchor::start, white);
  canvas.text({118.0, 29.0}, "the camera's path in a room where people walk about", 12.5,
              TextAnchor::start, pale);
  canvas.text({width - margin, 29.0},
              fmt::format("{}, seed {}, {} frames", result.scenario, result.options.seed,
                          result.best.frames),
              10.0, TextAnchor::end, pale);
}

void draw_card(Canvas& canvas, double left, double card_width, Colour colour,
               const std::string& figure, const std::string& what) {
  canvas.rectangle({left, cards_top}, {card_width, cards_height}, card_colour);
  canvas.rectangle({left, cards_top}, {4.0, cards_height}, colour);
  canvas.text({left + 14.0, cards_top + 24.0}, figure, 17.0, TextAnchor::start, dark);
  canvas.text({left + 14.0, cards_top + 41.0}, what, 9.5, TextAnchor::start, grey);
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
    canvas.text({left, frames_top - 5.0}, caption, 11.0, TextAnchor::start, dark);
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
  return canvas->encode();
}

}  // namespace dkp_slam::apps
