#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/evaluation/report/charts.h"

namespace dkp_slam::apps {

struct DemoOptions {
  std::filesystem::path out = "out/demo";
  std::uint64_t seed = 1;
  std::size_t frames =
      300;            ///< ten seconds: long enough for people to cross the view several times
  std::string model;  ///< YOLOX weights; empty: as dkp-slam run looks for them
  bool view = false;  ///< both runs are shown on a web page
  int port = 0;       ///< of that page; 0: any that is free, the same for both
};

/// One run of the demo and what it gave.
struct DemoRun {
  std::string mode;
  ScoredPath path;
  std::size_t frames = 0, lost = 0;
  double rpe_second_m = 0.0;   ///< RMSE over one second; 0 where the sequence is shorter
  double removed_share = 0.0;  ///< of the features, 0 to 1
  double frame_ms = 0.0;       ///< median
  double seconds = 0.0;        ///< the process from start to end
  std::string detector;        ///< in the program's words
  std::map<std::string, std::vector<double>> timings;  ///< timings.csv
  std::filesystem::path overlay;                       ///< folder of pictures
};

/// A frame as both runs saw it.
struct DemoFrame {
  int index = 0;
  cv::Mat off, best;  ///< CV_8UC3, BGR
};

struct DemoResult {
  DemoOptions options;
  std::string scenario;
  Trajectory truth;
  DemoRun off, best;
  bool yolox = false;  ///< else motion
  std::string model;   ///< file name of the weights
  std::vector<DemoFrame> frames;
  std::string version, machine, date;
};

/// Makes the sequence, runs it twice and gathers the results, each step a process of this program.
/// Throws `Error` when a step fails or was interrupted.
DemoResult make_demo(const DemoOptions& options);

/// The size of the picture, pixels.
constexpr int demo_picture_width = 1600, demo_picture_height = 1080;

/// One picture for a quick look, the bytes of a PNG file.
std::string demo_picture(const DemoResult& result);

/// The page, one file that needs no other.
std::string demo_page(const DemoResult& result);

/// "motion detector (no model needed)" or "YOLOX, yolox_nano.onnx".
std::string detector_text(const DemoResult& result);

/// The finding in a sentence: how the two errors compare.
std::string demo_finding(const DemoResult& result);

}  // namespace dkp_slam::apps
