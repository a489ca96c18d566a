#include "dkp_slam/calibration/calibration_plot.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/evaluation/axes.h"

namespace dkp_slam {
namespace {

using namespace chart;

constexpr Colour band_colour{205, 222, 240};
constexpr double title_size = 16.0;
constexpr double left = 78.0, right = 24.0, panel_height = 190.0;

/// A straight line through the middle of a panel.
struct Slope {
  double value = 0.0, sigma = 0.0;
};

void draw_slopes(Canvas& canvas, const Panel& panel, const Slope& found, double before) {
  const double x0 = panel.low.x(), x1 = panel.high.x();
  constexpr int steps = 60;
  // Three standard deviations: one would be thinner than the line.
  std::vector<Canvas::Line> band;
  for (int i = 0; i <= steps; ++i) {
    const double slope = found.value + (2.0 * i / steps - 1.0) * 3.0 * found.sigma;
    band.push_back(panel.page(Canvas::Line{{x0, slope * x0}, {x1, slope * x1}}));
  }
  canvas.lines(band, band_colour, 1.0);
  canvas.lines({panel.page(Canvas::Line{{x0, before * x0}, {x1, before * x1}})}, error_colour, 1.2);
  canvas.lines({panel.page(Canvas::Line{{x0, found.value * x0}, {x1, found.value * x1}})},
               estimate_colour, 1.4);
}

void draw_bins(Canvas& canvas, const Panel& panel, const std::vector<ProfileBin>& bins,
               double scale) {
  for (const ProfileBin& bin : bins) {
    const double y = scale * bin.value, s = scale * bin.sigma;
    if (y < panel.low.y() || y > panel.high.y()) continue;
    const Eigen::Vector2d at = panel.page(Eigen::Vector2d(bin.at, y));
    canvas.lines({panel.page(Canvas::Line{{bin.at, std::max(y - s, panel.low.y())},
                                          {bin.at, std::min(y + s, panel.high.y())}})},
                 ink, 1.0);
    canvas.rectangle(at - Eigen::Vector2d(2.5, 2.5), {5.0, 5.0}, ink);
  }
}

/// So high that the bins and both lines are seen, and no less than this.
double height_for(const std::vector<ProfileBin>& bins, double scale, double end, double least) {
  double high = std::max(least, std::abs(end));
  for (const ProfileBin& bin : bins) high = std::max(high, std::abs(scale * bin.value));
  return 1.15 * high;
}

const FoundValue& value_of(const Calibration& calibration, const std::string& key) {
  return *std::find_if(calibration.values.begin(), calibration.values.end(),
                       [&](const FoundValue& v) { return v.key == key; });
}

void draw_legend_at(Canvas& canvas, double y) {
  draw_legend(canvas, {calibration_plot_width - right, y},
              {{"measured", ink, 3.0},
               {"found, 3 sd", estimate_colour, 2.0},
               {"file before", error_colour, 1.6}});
}

}  // namespace

void draw_calibration(Canvas& canvas, const Calibration& calibration, const std::string& title) {
  constexpr double ms = 1e3;
  const double width = calibration_plot_width - left - right;
  canvas.text({24.0, 32.0}, title, title_size, TextAnchor::start, ink);
  const FoundValue& readout = value_of(calibration, "readout");
  const FoundValue& delay = value_of(calibration, "depth_delay");
  canvas.text({left, 54.0},
              fmt::format("readout {:.2f} +- {:.2f} ms (was {:.2f})", ms * readout.value,
                          ms * readout.sigma, ms * readout.before),
              text_size, TextAnchor::start, ink);
  const double rows_high =
      height_for(calibration.rows, ms, 0.5 * ms * std::max(readout.value, readout.before), 1.0);
  const Panel rows{{left, 86.0}, {width, panel_height}, {-0.5, -rows_high}, {0.5, rows_high}};
  draw_axes(canvas, rows, round_ticks(-0.5, 0.5, 10), round_ticks(-rows_high, rows_high, 6),
            "row, from the first (-0.5) to the last (0.5)", "seen later by [ms]");
  draw_slopes(canvas, rows, {ms * readout.value, ms * readout.sigma}, ms * readout.before);
  draw_bins(canvas, rows, calibration.rows, ms);
  draw_legend_at(canvas, 76.0);

  canvas.text({left, 344.0},
              fmt::format("delay of depth {:.2f} +- {:.2f} ms (was {:.2f})", ms * delay.value,
                          ms * delay.sigma, ms * delay.before),
              text_size, TextAnchor::start, ink);
  // Drawn as the stamps say it: what the last round was given is added again.
  std::vector<ProfileBin> rates = calibration.rates;
  for (ProfileBin& bin : rates) bin.value += bin.at * calibration.delay_before;
  double widest = 0.05;
  for (const ProfileBin& bin : rates) widest = std::max(widest, 1.1 * std::abs(bin.at));
  const double end = ms * widest * std::max(std::abs(delay.value), std::abs(delay.before));
  const double rates_high = height_for(rates, ms, end, 0.5);
  const Panel depth{
      {left, 376.0}, {width, panel_height}, {-widest, -rates_high}, {widest, rates_high}};
  draw_axes(canvas, depth, round_ticks(-widest, widest, 10),
            round_ticks(-rates_high, rates_high, 6), "inverse depth changes by [1/(m s)]",
            "off by [1/km]");
  draw_slopes(canvas, depth, {ms * delay.value, ms * delay.sigma}, ms * delay.before);
  draw_bins(canvas, depth, rates, ms);
  draw_legend_at(canvas, 366.0);
}

}  // namespace dkp_slam
