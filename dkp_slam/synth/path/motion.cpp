#include "dkp_slam/synth/path/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>

#include <opencv2/core.hpp>

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

constexpr int freedoms = 6;
constexpr int octaves = 7;
constexpr double lowest_frequency = 0.04;  // Hz, where the first octave begins
/// Root mean square of each degree of freedom in each octave: sideways, ahead and up (metres; of a
/// motion around a point azimuth, elevation and distance), yaw, pitch and roll (radians).
using Spectrum = std::array<std::array<double, freedoms>, octaves>;

// Output of scripts/motion_spectrum.py for the ground truth of the sequences named, octave by
// octave. freiburg3_walking_xyz
constexpr Spectrum xyz_spectrum = {{
    {{0.09826, 0.07449, 0.10055, 0.04374, 0.06265, 0.01153}},
    {{0.10622, 0.13555, 0.13372, 0.05002, 0.00901, 0.02172}},
    {{0.07798, 0.07728, 0.08077, 0.05715, 0.03132, 0.01870}},
    {{0.01954, 0.01052, 0.02804, 0.01617, 0.02291, 0.01408}},
    {{0.00509, 0.00448, 0.01019, 0.01079, 0.01296, 0.00681}},
    {{0.00130, 0.00114, 0.00177, 0.00612, 0.00527, 0.00561}},
    {{0.00027, 0.00041, 0.00041, 0.00301, 0.00404, 0.00366}},
}};
// freiburg3_sitting_xyz
constexpr Spectrum slow_xyz_spectrum = {{
    {{0.15956, 0.15824, 0.16589, 0.02308, 0.03759, 0.03702}},
    {{0.09223, 0.07769, 0.08156, 0.02490, 0.02201, 0.02181}},
    {{0.03762, 0.04569, 0.04004, 0.03013, 0.02827, 0.01600}},
    {{0.00925, 0.00940, 0.01102, 0.01530, 0.01152, 0.00780}},
    {{0.00291, 0.00241, 0.00336, 0.00683, 0.00668, 0.00567}},
    {{0.00104, 0.00104, 0.00126, 0.00414, 0.00334, 0.00373}},
    {{0.00027, 0.00025, 0.00027, 0.00196, 0.00270, 0.00244}},
}};
// freiburg3_walking_rpy
constexpr Spectrum rpy_spectrum = {{
    {{0.07796, 0.08181, 0.02063, 0.11358, 0.12779, 0.27421}},
    {{0.09932, 0.03469, 0.02257, 0.18911, 0.17755, 0.21066}},
    {{0.07485, 0.03268, 0.01276, 0.22924, 0.09502, 0.13484}},
    {{0.01443, 0.01766, 0.00776, 0.06306, 0.06271, 0.04138}},
    {{0.00665, 0.00402, 0.00264, 0.01411, 0.02058, 0.00952}},
    {{0.00078, 0.00078, 0.00111, 0.00695, 0.00795, 0.00490}},
    {{0.00024, 0.00024, 0.00037, 0.00254, 0.00401, 0.00278}},
}};
// freiburg3_walking_halfsphere (--sphere)
constexpr Spectrum halfsphere_spectrum = {{
    {{0.23005, 0.17619, 0.08919, 0.05349, 0.06284, 0.21695}},
    {{0.25117, 0.17500, 0.04591, 0.08306, 0.07132, 0.35386}},
    {{0.06838, 0.05673, 0.05589, 0.05791, 0.08492, 0.18606}},
    {{0.01486, 0.01816, 0.02154, 0.03450, 0.02981, 0.04743}},
    {{0.00443, 0.00263, 0.00392, 0.01916, 0.01920, 0.01738}},
    {{0.00133, 0.00128, 0.00131, 0.00686, 0.00735, 0.00758}},
    {{0.00031, 0.00039, 0.00037, 0.00307, 0.00427, 0.00444}},
}};
// freiburg3_walking_static
constexpr Spectrum still_spectrum = {{
    {{0.00693, 0.00283, 0.00686, 0.00962, 0.03377, 0.01043}},
    {{0.01160, 0.00946, 0.00515, 0.00903, 0.03045, 0.00632}},
    {{0.00718, 0.00445, 0.00237, 0.00394, 0.01115, 0.00709}},
    {{0.00358, 0.00152, 0.00358, 0.00491, 0.00472, 0.00629}},
    {{0.00163, 0.00070, 0.00107, 0.00348, 0.00369, 0.00341}},
    {{0.00049, 0.00031, 0.00053, 0.00197, 0.00253, 0.00262}},
    {{0.00017, 0.00017, 0.00021, 0.00086, 0.00184, 0.00138}},
}};

struct Recording {
  const Spectrum& spectrum;
  /// Our hand never pauses, those of the recordings do: at this share of their pace it covers the
  /// same ground in the same time.
  double pace;
};

Recording recording_of(SyntheticMotion motion) {
  switch (motion) {
    case SyntheticMotion::xyz:
      return {xyz_spectrum, 0.85};
    case SyntheticMotion::slow_xyz:
      return {slow_xyz_spectrum, 0.80};
    case SyntheticMotion::rpy:
      return {rpy_spectrum, 0.72};
    case SyntheticMotion::halfsphere:
      return {halfsphere_spectrum, 0.72};
    case SyntheticMotion::still:
      break;
  }
  return {still_spectrum, 0.75};
}

/// A sum of sine waves with the amplitudes of a spectrum: two in each octave, so that no motion
/// comes again, at frequencies and phases of the seed.
class Waves {
 public:
  Waves(const Recording& recording, std::uint64_t seed) {
    cv::RNG rng(seed * 2 + 77);
    for (int octave = 0; octave < octaves; ++octave) {
      for (int freedom = 0; freedom < freedoms; ++freedom) {
        for (int half = 0; half < 2; ++half) {
          const double exponent = octave + 0.5 * half + rng.uniform(0.05, 0.45);
          Wave wave;
          wave.pulsation =
              2.0 * std::numbers::pi * lowest_frequency * std::exp2(exponent) * recording.pace;
          wave.phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
          // Two sines of amplitude a have together the root mean square a.
          wave.amplitude = recording.spectrum[std::size_t(octave)][std::size_t(freedom)];
          waves_[std::size_t(freedom)][std::size_t(2 * octave + half)] = wave;
        }
      }
    }
  }

  Vector6d at(double time) const {
    Vector6d sum = Vector6d::Zero();
    for (int freedom = 0; freedom < freedoms; ++freedom) {
      for (const Wave& w : waves_[std::size_t(freedom)]) {
        sum[freedom] += w.amplitude * std::sin(w.pulsation * time + w.phase);
      }
    }
    return sum;
  }

 private:
  struct Wave {
    double amplitude = 0.0, pulsation = 0.0, phase = 0.0;
  };
  std::array<std::array<Wave, 2 * octaves>, freedoms> waves_;
};

constexpr double sphere_radius = 1.177;     // metres, the mean distance from what is looked at
constexpr double sphere_elevation = 0.190;  // radians, of the camera above it

}  // namespace

Eigen::Quaterniond camera_view(double heading, double pitch, double roll) {
  const Eigen::AngleAxisd turn(heading, Vector3d::UnitZ());
  const Eigen::AngleAxisd lift(pitch, Vector3d::UnitX());
  const Eigen::AngleAxisd tilt(-roll, Vector3d::UnitY());
  const Eigen::AngleAxisd level(-std::numbers::pi / 2.0, Vector3d::UnitX());
  return Eigen::Quaterniond(turn * lift * tilt * level);
}

double from_rest(double time) {
  time = std::max(time, 0.0);
  return time < 1.0 ? 0.5 * time * time : time - 0.5;
}

CameraPath hand_motion(SyntheticMotion motion, std::uint64_t seed, const Standpoint& at) {
  const Waves waves(recording_of(motion), seed);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(at.heading, Vector3d::UnitZ()));
  if (motion != SyntheticMotion::halfsphere) {
    return [=](double time) {
      const Vector6d w = waves.at(from_rest(time));
      return Se3(camera_view(at.heading + w[3], at.pitch + w[4], w[5]),
                 at.position + turn * Vector3d(w.head<3>()));
    };
  }
  const auto around = [](double azimuth, double elevation) {
    return Vector3d(std::sin(azimuth) * std::cos(elevation),
                    -std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
  };
  const Vector3d target = at.position - turn * (sphere_radius * around(0.0, sphere_elevation));
  return [=](double time) {
    const Vector6d w = waves.at(from_rest(time));
    const double azimuth = w[0], elevation = sphere_elevation + w[1];
    const Vector3d away = turn * ((sphere_radius + w[2]) * around(azimuth, elevation));
    return Se3(camera_view(at.heading + azimuth + w[3], w[4] - elevation, w[5]), target + away);
  };
}

}  // namespace dkp_slam
