#include "apps/sequence_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/png_encoder.h"
#include "dkp_slam/synth/true_detections.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;

void write_image(const fs::path& path, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(path.string() + ": cannot write; is the disk full?");
}

/// Frames' stamps and every hundredth of a second between, each moment once.
std::vector<double> truth_stamps(const std::vector<double>& frames) {
  constexpr double rate = 100.0, same = 1e-5;  // Hz, seconds
  std::vector<double> stamps = frames;
  if (frames.empty()) return stamps;
  const auto first = std::llround(frames.front() * rate), last = std::llround(frames.back() * rate);
  for (auto i = first; i <= last; ++i) {
    const double stamp = static_cast<double>(i) / rate;
    if (stamp > frames.front() && stamp < frames.back()) stamps.push_back(stamp);
  }
  std::sort(stamps.begin(), stamps.end());
  const auto repeats = [](double a, double b) { return b - a < same; };
  stamps.erase(std::unique(stamps.begin(), stamps.end(), repeats), stamps.end());
  return stamps;
}

}  // namespace

const std::vector<std::string>& SequenceWriter::names() {
  static const std::vector<std::string> all = {"rgb",
                                               "depth",
                                               "mask",
                                               "instances",
                                               "camera.yaml",
                                               "rgb.txt",
                                               "depth.txt",
                                               "associations.txt",
                                               "groundtruth.txt",
                                               "detections.txt"};
  return all;
}

SequenceWriter::SequenceWriter(fs::path out, const Camera& camera)
    : out_(std::move(out)), depth_scale_(camera.depth_scale) {
  try {
    for (const char* folder : {"rgb", "depth", "mask", "instances"}) {
      fs::create_directory(out_ / folder);
    }
  } catch (const fs::filesystem_error& error) {
    throw Error(
        fmt::format("{}: cannot make its folders: {}", out_.string(), error.code().message()));
  }
  save_camera(camera, out_ / "camera.yaml");
}

void SequenceWriter::add(const RgbdFrame& frame, const SyntheticTruth& truth) {
  // One frame in work per core: enough to keep them busy, and little memory.
  wait_for(std::max(std::thread::hardware_concurrency(), 1U) - 1);
  const std::string stamp = fmt::format("{:.6f}", frame.timestamp);
  const std::string colour = "rgb/" + stamp + ".png", depth = "depth/" + stamp + ".png";
  writing_.push_back(std::async(std::launch::async, [=, this] {
    cv::Mat units;
    frame.depth.convertTo(units, CV_16U, depth_scale_);
    write_image(out_ / colour, frame.colour);
    write_image(out_ / depth, units);
    write_image(out_ / "mask" / (stamp + ".png"), truth.mask);
    write_image(out_ / "instances" / (stamp + ".png"), truth.instance);
  }));
  rgb_ += fmt::format("{} {}\n", stamp, colour);
  depth_ += fmt::format("{} {}\n", stamp, depth);
  associations_ += fmt::format("{} {} {} {}\n", stamp, colour, stamp, depth);
  detections_ += recorded_lines(frame.timestamp, true_detections(truth));
  stamps_.push_back(frame.timestamp);
}

void SequenceWriter::wait_for(std::size_t images_left) {
  while (writing_.size() > images_left) {
    std::future<void> oldest = std::move(writing_.front());
    writing_.pop_front();
    oldest.get();
  }
}

void SequenceWriter::finish(const SyntheticSource& source) {
  wait_for(0);
  Trajectory truth;
  for (const double stamp : truth_stamps(stamps_)) {
    truth.push_back({stamp, source.world_from_camera(stamp)});
  }
  write_file_atomically(out_ / "rgb.txt", "# timestamp filename\n" + rgb_);
  write_file_atomically(out_ / "depth.txt", "# timestamp filename\n" + depth_);
  write_file_atomically(out_ / "associations.txt", associations_);
  write_file_atomically(out_ / "detections.txt", recorded_header() + detections_);
  write_trajectory(out_ / "groundtruth.txt", truth);
}

}  // namespace dkp_slam::apps
