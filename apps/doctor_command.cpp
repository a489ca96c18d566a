#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "dkp_slam/dense/octomap/octomap_file.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/detection/yolox_options.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/statistics.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/sensor/bag/bag_source.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"
#include "dkp_slam/stopwatch.h"
#include "dkp_slam/version.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

/// One line of the report.
struct Finding {
  enum class State { good, missing, bad } state = State::good;
  std::string what;    ///< "detector"
  std::string text;    ///< what was found
  std::string remedy;  ///< the command that mends it; empty where nothing is to be mended
};

constexpr int image_width = 640, image_height = 480;
constexpr double test_seconds = 1.0;  // of each of the two measurements

/// A picture with corners everywhere, the same each time.
cv::Mat test_picture() {
  constexpr int square = 16;  // pixels
  cv::Mat squares(image_height / square, image_width / square, CV_8UC1), grey, picture;
  cv::RNG(1).fill(squares, cv::RNG::UNIFORM, 0, 256);
  cv::resize(squares, grey, {image_width, image_height}, 0.0, 0.0, cv::INTER_NEAREST);
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

/// Median milliseconds of what is done again and again for `test_seconds`.
double median_ms(const std::function<void()>& work) {
  std::vector<double> times;
  const Stopwatch all;
  do {
    const Stopwatch one;
    work();
    times.push_back(one.ms());
  } while (all.ms() < 1000.0 * test_seconds);
  return median(times);
}

Finding processor() {
  double gib = 0.0;
  std::ifstream info("/proc/meminfo");
  for (std::string word; info >> word;) {
    if (word == "MemAvailable:" && info >> word) gib = std::stod(word) / (1024.0 * 1024.0);
  }
  const unsigned cores = std::thread::hardware_concurrency();
  Finding found{Finding::State::good, "processor",
                fmt::format("{} cores, {:.1f} GiB of memory free", cores, gib), ""};
  if (cores < 2) {
    found.state = Finding::State::missing;
    found.remedy = "two cores carry 30 images a second; with one: run --detector motion";
  }
  return found;
}

Finding libraries() {
  Finding found{Finding::State::good, "libraries", fmt::format("OpenCV {}", CV_VERSION), ""};
#ifdef DKP_SLAM_HAVE_ONNXRUNTIME
  found.text += ", ONNX Runtime";
#else
  found.state = Finding::State::missing;
  found.text += ", no ONNX Runtime: YOLOX runs on OpenCV, about 4 times slower";
  found.remedy = "scripts/setup.sh && scripts/build.sh";
#endif
  return found;
}

/// What is built in only where its library was there.
Finding parts() {
  const struct {
    const char *name, *extra;  // of `scripts/setup.sh --with`
    bool there;
  } all[] = {{"Kinect", "kinect", can_read_kinects()},
             {"bags", "ros", can_read_bags()},
             {"OctoMap", "dense", has_octomap()}};
  std::vector<const char*> there, missing, extras;
  for (const auto& part : all) {
    (part.there ? there : missing).push_back(part.name);
    if (!part.there) extras.push_back(part.extra);
  }
  Finding found{Finding::State::good, "parts", fmt::format("{}", fmt::join(there, ", ")), ""};
  if (missing.empty()) return found;
  found.state = Finding::State::missing;
  found.text += fmt::format("{}without {}", there.empty() ? "" : "; ", fmt::join(missing, ", "));
  found.remedy = fmt::format("only who needs them: scripts/setup.sh --with {} && scripts/build.sh",
                             fmt::join(extras, ","));
  return found;
}

Finding cameras() {
  try {
    choose_camera({}, "fr1");  // all lie in one folder
    return {Finding::State::good, "cameras", camera_names, ""};
  } catch (const Error& error) {
    return {Finding::State::missing, "cameras", error.what(), "name one: run --camera FILE"};
  }
}

/// The detector that `run` would take, and its time for one image.
Finding detector(const cv::Mat& picture, double& ms) {
  std::optional<fs::path> model;
  try {
    model = find_model();
    if (!model) {
      return {Finding::State::missing, "detector",
              "no YOLOX weights: the motion detector runs, which sees only who moves",
              "scripts/fetch_model.sh (installed: dkp-slam-fetch-model)"};
    }
    YoloxOptions options;
    options.model = *model;
    const auto yolox = make_yolox_detector(options);
    RgbdFrame frame;
    frame.colour = picture;
    ms = median_ms([&] { yolox->detect(frame); });
    return {Finding::State::good, "detector",
            fmt::format("{}, {}, {:.1f} ms an image", yolox->name(), model->string(), ms), ""};
  } catch (const Error& error) {
    return {Finding::State::bad, "detector", error.what(),
            "scripts/fetch_model.sh, or unset DKP_SLAM_MODEL"};
  }
}

Finding speed(const cv::Mat& picture, double detector_ms) {
  cv::Mat grey;
  cv::extractChannel(picture, grey, 0);
  const OrbExtractor orb;
  const double ms = median_ms([&] { orb.extract(grey); });
  // Measured (docs/results.md): all threads together work four times as long on a frame as its
  // features take. Two cores share that, but for the detector, which is a thread's own work.
  constexpr double work_per_features = 4.0;
  const unsigned shared_by = std::clamp(std::thread::hardware_concurrency(), 1U, 2U);
  const double frame = std::max(work_per_features * ms / shared_by, detector_ms);
  Finding found{Finding::State::good, "speed",
                fmt::format("features of a 640 x 480 image {:.1f} ms; about {:.0f} images a second "
                            "in all",
                            ms, 1000.0 / frame),
                ""};
  constexpr double camera_ms = 33.3;
  if (frame > camera_ms) {
    found.state = Finding::State::missing;
    found.text += ", fewer than a camera's 30";
    found.remedy = "run --set orb.features=600, or a quieter machine";
  }
  return found;
}

void doctor() {
  const cv::Mat picture = test_picture();
  double detector_ms = 0.0;
  std::vector<Finding> findings{processor(), libraries(), parts(), cameras()};
  findings.push_back(detector(picture, detector_ms));
  findings.push_back(speed(picture, detector_ms));
  fmt::print("dkp-slam {}\n", DKP_SLAM_VERSION);
  bool bad = false;
  for (const Finding& f : findings) {
    const char* const mark[] = {"ok", "--", "!!"};
    fmt::print("{} {:<10} {}\n", mark[static_cast<int>(f.state)], f.what, f.text);
    if (!f.remedy.empty()) fmt::print("   {:<10} {}\n", "", "-> " + f.remedy);
    bad = bad || f.state == Finding::State::bad;
  }
  std::fflush(stdout);
  if (bad)
    throw Error("what is marked !! keeps it from running; the line below each says what to do");
}

}  // namespace

void add_doctor_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "doctor",
      "Tells what this machine has, which detector would run and how fast, what is missing and the "
      "command that mends it. Takes two seconds.");
  command->callback([] { doctor(); });
}

}  // namespace dkp_slam::apps
