#include "dkp_slam/calibration/calibrate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "dkp_slam/calibration/sighting_recorder.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/dynamics/modes.h"
#include "dkp_slam/error.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam {
namespace {

// Changes from round to round that change nothing more.
constexpr double same_readout = 0.0005, same_delay = 0.001;  // seconds
constexpr double same_depth_distortion = 0.001;              // 1/metre

/// To a multiple of 1 / `parts`, as text holds it.
double rounded(double value, double parts) { return std::round(value * parts) / parts; }

/// What is known so far.
struct State {
  SlamConfig config;
  Trajectory first_path;  ///< of the first sequence
};

struct Played {
  std::vector<SightedFrame> frames;
  Trajectory path;
};

class Calibrator {
 public:
  Calibrator(const std::vector<CalibrationSequence>& sequences, const SlamConfig& config,
             const CalibrationOptions& options, const CalibrationProgress& progress)
      : sequences_(sequences), options_(options), progress_(progress), start_(config.camera) {
    state_.config = config;
    free_.fill(false);
    free_[readout_parameter] = free_[delay_parameter] = true;
    free_[bias_parameter] = options.bias;
    if (options.depth_distortion) {
      for (int i = 0; i < DepthDistortion::size; ++i)
        free_[static_cast<std::size_t>(depth_distortion_parameter + i)] = true;
    }
    if (options.focal) free_[fx_parameter] = free_[fy_parameter] = true;
    if (options.principal_point) free_[cx_parameter] = free_[cy_parameter] = true;
    if (options.distortion) {
      for (int p : {k1_parameter, k2_parameter, p1_parameter, p2_parameter, k3_parameter})
        free_[static_cast<std::size_t>(p)] = true;
    }
  }

  Calibration run() {
    for (int round = 1; round <= options_.rounds; ++round) {
      out_.rounds = round;
      const Camera before = state_.config.camera;
      std::vector<Window> windows = look(round);
      const Parameters from = parameters_of(before);
      Adjustment found = adjust_windows(windows, before, from, free_);
      check(found, windows);
      if (!known(found, bias_parameter, options_.most_bias_sigma) && free_[bias_parameter]) {
        bias_sigma_ = sigma(found, bias_parameter);
        free_[bias_parameter] = false;
        found = adjust_windows(windows, before, from, free_);
        check(found, windows);
      }
      const bool settled =
          std::abs(found.parameters[readout_parameter] - from[readout_parameter]) < same_readout &&
          std::abs(found.parameters[delay_parameter]) < same_delay &&
          depth_distortion_of(found.parameters).cwiseAbs().maxCoeff() < same_depth_distortion;
      take(found, windows);
      if (settled) break;
    }
    find_scale();
    list_values();
    return out_;
  }

 private:
  static double sigma(const Adjustment& a, int parameter) {
    return std::sqrt(a.covariance(parameter, parameter));
  }
  static bool known(const Adjustment& a, int parameter, double most) {
    return sigma(a, parameter) <= most;
  }

  void stop_if_asked() const {
    if (options_.stop && *options_.stop) throw Error("calibrate: interrupted; nothing was written");
  }

  std::vector<Window> look(int round) {
    std::vector<Window> windows;
    out_.frames = 0;
    for (std::size_t i = 0; i < sequences_.size(); ++i) {
      const Played played = play_sequence(sequences_[i], round);
      if (i == 0) state_.first_path = played.path;
      out_.frames += static_cast<int>(played.frames.size());
      for (Window& w : make_windows(played.frames, state_.config.camera, options_.windows))
        windows.push_back(std::move(w));
    }
    if (windows.empty()) {
      throw Error(fmt::format(
          "calibrate: too little was seen: {} frames were localised, none of them in a second and "
          "a "
          "half with {} landmarks; record ten seconds of a well lit room with things in it",
          out_.frames, options_.windows.least_points));
    }
    return windows;
  }

  Played play_sequence(const CalibrationSequence& sequence, int round) {
    const auto source = sequence.open(state_.config.camera);
    const std::size_t frames = source->size().value_or(0);
    std::unique_ptr<Detector> detector;
    if (mode_info(state_.config.dynamics.mode).detector)
      detector = make_detector(state_.config.detector, state_.config.camera);
    Slam slam(state_.config, std::move(detector));
    const auto recorder = std::make_shared<SightingRecorder>(state_.config);
    slam.add_observer(recorder, {Delivery::every});
    PlaybackOptions playback;
    playback.stop = options_.stop;
    play(*source, slam, playback, [&](const FrameResult& result) {
      if (progress_) progress_(round, static_cast<std::size_t>(result.index) + 1, frames);
    });
    stop_if_asked();
    Played played;
    played.path = slam.trajectory();
    played.frames = recorder->frames_on(played.path);
    return played;
  }

  /// Throws where the readout or the delay is not known.
  void check(const Adjustment& found, const std::vector<Window>& windows) {
    constexpr double still = 12.0;  // pixels per second of an image 640 wide
    const Camera& camera = state_.config.camera;
    out_.image_speed = image_speed(windows, found.parameters);
    const double speed = out_.image_speed * 640.0 / camera.width;
    const bool moves = speed >= still;
    if (moves && known(found, readout_parameter, options_.most_readout_sigma) &&
        known(found, delay_parameter, options_.most_delay_sigma)) {
      return;
    }
    const std::string why =
        moves ? fmt::format(
                    "the camera's motion is too even: readout would be known to {:.1f} ms "
                    "and the delay of depth to {:.1f} ms, {:g} and {:g} ms are needed",
                    1e3 * sigma(found, readout_parameter), 1e3 * sigma(found, delay_parameter),
                    1e3 * options_.most_readout_sigma, 1e3 * options_.most_delay_sigma)
              : fmt::format("the camera hardly moves ({:.0f} pixels per second)", speed);
    throw Error(fmt::format(
        "calibrate: {}; turn it to and fro, left and right, up and down, about once a second, and "
        "move it nearer and away, for twenty seconds",
        why));
  }

  void take(const Adjustment& found, const std::vector<Window>& windows) {
    const Parameters& p = found.parameters;
    for (int i = 0; i < parameter_count; ++i) sigmas_[i] = sigma(found, i);
    const double frame = 1.0 / start_.frame_rate;
    const double slack = 0.001 + 3.0 * sigmas_[readout_parameter];
    if (p[readout_parameter] < -slack || p[readout_parameter] > frame + slack) {
      throw Error(fmt::format(
          "calibrate: the images give a readout of {:.1f} ms, which no camera of {:g} Hz has; are "
          "the time stamps and the lens of the camera file right?",
          1e3 * p[readout_parameter], start_.frame_rate));
    }
    out_.rows = row_profile(windows, p);
    out_.rates = depth_profile(windows, p);
    out_.delay_before = state_.config.camera.depth_correction.delay;
    Camera camera = with_parameters(state_.config.camera, p);
    camera.readout = std::clamp(rounded(camera.readout, 1e6), 0.0, frame);
    if (options_.focal) take_focal(camera);
    if (options_.principal_point) take_principal_point(camera);
    if (options_.depth_distortion) take_depth_distortion(depth_distortion_of(p), camera);
    DepthCorrection& depth = camera.depth_correction;
    depth.delay = rounded(depth.delay + p[delay_parameter], 1e6);
    depth.bias = rounded(depth.bias + p[bias_parameter], 1e5);
    if (const auto reason = camera.check()) {
      throw Error("calibrate: what was found makes no camera (" + *reason +
                  "); give a camera file that is nearer to the truth");
    }
    state_.config.camera = camera;
    out_.noise = found.noise;
    out_.windows = static_cast<int>(windows.size());
    out_.sightings = found.sightings;
    out_.depths = found.depths;
  }

  void take_focal(Camera& camera) const {
    camera.fx = rounded(camera.fx, 1e3);
    camera.fy = rounded(camera.fy, 1e3);
    const double worst =
        std::max(sigmas_[fx_parameter] / camera.fx, sigmas_[fy_parameter] / camera.fy);
    if (worst <= options_.most_focal_sigma) return;
    throw Error(
        fmt::format("calibrate: the focal length would be known to {:.1f} %, {:g} % is "
                    "needed; turn the camera further, or leave out --focal",
                    100.0 * worst, 100.0 * options_.most_focal_sigma));
  }

  void take_principal_point(Camera& camera) const {
    camera.cx = rounded(camera.cx, 1e3);
    camera.cy = rounded(camera.cy, 1e3);
    const double worst = std::max(sigmas_[cx_parameter], sigmas_[cy_parameter]);
    const double most = options_.most_principal_point_sigma * camera.width / 640.0;
    if (worst <= most) return;
    throw Error(fmt::format(
        "calibrate: the principal point would be known to {:.1f} pixels, {:g} are needed; turn the "
        "camera further, also about its line of sight, or leave out --principal-point",
        worst, most));
  }

  void take_depth_distortion(const DepthDistortion::Terms& found, Camera& camera) const {
    auto& coefficients = camera.depth_correction.distortion.coefficients;
    for (int i = 0; i < DepthDistortion::size; ++i)
      coefficients[i] = rounded(coefficients[i] + found[i], 1e5);
    const double worst = depth_distortion_of(sigmas_).maxCoeff();
    if (worst <= options_.most_depth_distortion_sigma) return;
    throw Error(fmt::format(
        "calibrate: the depth distortion would be known to {:.4f} 1/metre, {:g} are needed; show "
        "the same things in the middle and at all borders of the image, or leave out "
        "--depth-distortion",
        worst, options_.most_depth_distortion_sigma));
  }

  void find_scale() {
    if (options_.lengths.empty()) return;
    double sum = 0.0, weights = 0.0;
    for (const KnownLength& length : options_.lengths) {
      const auto source = sequences_.front().open(state_.config.camera);
      const MeasuredLength m =
          measure_length(length, *source, state_.config.camera, state_.first_path);
      const double weight = std::pow(length.metres / m.sigma, 2);
      sum += weight * m.metres / length.metres;
      weights += weight;
    }
    // Too long by this factor: as many more units make a metre, and of the bias as much less.
    // Inverse depths grow by it.
    const double factor = sum / weights;
    if (std::abs(factor - 1.0) > 0.3) {
      throw Error(
          fmt::format("calibrate: by the known length depth is wrong by a factor of {:.2f}; "
                      "are pixels, time stamp and metres right?",
                      factor));
    }
    Camera& camera = state_.config.camera;
    scale_sigma_ = camera.depth_scale * factor / std::sqrt(weights);
    camera.depth_scale = rounded(camera.depth_scale * factor, 1e2);
    DepthCorrection& depth = camera.depth_correction;
    depth.bias = rounded(depth.bias / factor, 1e5);
    for (double& c : depth.distortion.coefficients) c = rounded(c * factor, 1e5);
  }

  void list_values() {
    out_.camera = state_.config.camera;
    const Camera& c = out_.camera;
    auto& v = out_.values;
    v.push_back({"readout", "s", start_.readout, c.readout, sigmas_[readout_parameter], true, ""});
    v.push_back({"depth_delay", "s", start_.depth_correction.delay, c.depth_correction.delay,
                 sigmas_[delay_parameter], true, ""});
    v.push_back({"depth_bias", "m", start_.depth_correction.bias, c.depth_correction.bias,
                 sigmas_[bias_parameter], free_[bias_parameter], ""});
    if (!options_.bias) {
      v.back().reason = "it is sought with --bias";
    } else if (!free_[bias_parameter]) {
      v.back().reason = fmt::format(
          "the motion tells it to {:.0f} mm only: move sideways before things near and far",
          1e3 * bias_sigma_);
    }
    v.push_back({"depth_scale", "units/m", start_.depth_scale, c.depth_scale, scale_sigma_,
                 !options_.lengths.empty(), ""});
    if (options_.lengths.empty())
      v.back().reason = "images alone do not tell it: give a known length, --length";
    list_depth_distortion();
    const auto lens = [&](const char* key, double before, double value, int parameter) {
      if (free_[static_cast<std::size_t>(parameter)])
        v.push_back({key, parameter < k1_parameter ? "px" : "", before, value, sigmas_[parameter],
                     true, ""});
    };
    lens("fx", start_.fx, c.fx, fx_parameter);
    lens("fy", start_.fy, c.fy, fy_parameter);
    lens("cx", start_.cx, c.cx, cx_parameter);
    lens("cy", start_.cy, c.cy, cy_parameter);
    const Distortion &a = start_.distortion, &b = c.distortion;
    lens("k1", a.k1, b.k1, k1_parameter);
    lens("k2", a.k2, b.k2, k2_parameter);
    lens("p1", a.p1, b.p1, p1_parameter);
    lens("p2", a.p2, b.p2, p2_parameter);
    lens("k3", a.k3, b.k3, k3_parameter);
  }

  void list_depth_distortion() {
    if (!options_.depth_distortion) return;
    static const std::array<const char*, DepthDistortion::size> terms = {
        "x", "y", "xx", "xy", "yy", "xxx", "xxy", "xyy", "yyy"};
    for (int i = 0; i < DepthDistortion::size; ++i) {
      out_.values.push_back({fmt::format("depth_{}", terms[static_cast<std::size_t>(i)]), "1/m",
                             start_.depth_correction.distortion.coefficients[i],
                             out_.camera.depth_correction.distortion.coefficients[i],
                             sigmas_[depth_distortion_parameter + i], true, ""});
    }
  }

  const std::vector<CalibrationSequence>& sequences_;
  const CalibrationOptions& options_;
  const CalibrationProgress& progress_;
  Camera start_;
  State state_;
  ParameterChoice free_{};
  Parameters sigmas_ = Parameters::Zero();
  double bias_sigma_ = 0.0, scale_sigma_ = 0.0;
  Calibration out_;
};

}  // namespace

Calibration calibrate(const std::vector<CalibrationSequence>& sequences, const SlamConfig& config,
                      const CalibrationOptions& options, const CalibrationProgress& progress) {
  if (sequences.empty()) throw Error("calibrate: no sequence; give at least one");
  return Calibrator(sequences, config, options, progress).run();
}

std::string calibration_text(const Calibration& calibration, const std::string& made_by) {
  std::string text = "# " + made_by + "\n";
  text += fmt::format(
      "# {} frames, {} sightings, {} depths; what was found, with its standard "
      "deviation:\n",
      calibration.frames, calibration.sightings, calibration.depths);
  for (const FoundValue& v : calibration.values) {
    if (v.found) {
      text += fmt::format("#   {:<12} {:.6g} +- {:.2g} {} (was {:.6g})\n", v.key, v.value, v.sigma,
                          v.unit, v.before);
    } else {
      text += fmt::format("#   {:<12} as it was: {}\n", v.key, v.reason);
    }
  }
  return text + camera_text(calibration.camera);
}

}  // namespace dkp_slam
