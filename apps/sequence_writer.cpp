#include "apps/sequence_writer.h"

#include <algorithm>
#include <array>
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

constexpr std::array image_folders = {"rgb", "depth", "mask", "instances"};

fs::path image_file(const fs::path& out, const char* folder, const std::string& stamp) {
  return out / folder / (stamp + ".png");
}

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
    for (const char* folder : image_folders) {
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
  Frame added;
  added.timestamp = frame.timestamp;
  added.stamp = fmt::format("{:.6f}", frame.timestamp);
  added.detections = recorded_lines(frame.timestamp, true_detections(truth));
  added.images = std::async(std::launch::async, [this, stamp = added.stamp, frame, truth] {
    cv::Mat units;
    frame.depth.convertTo(units, CV_16U, depth_scale_);
    const std::array images = {frame.colour, units, truth.mask, truth.instance};
    for (std::size_t i = 0; i < images.size(); ++i) {
      write_image(image_file(out_, image_folders[i], stamp), images[i]);
    }
  });
  writing_.push_back(std::move(added));
}

void SequenceWriter::wait_for(std::size_t frames_left) {
  while (writing_.size() > frames_left) {
    Frame oldest = std::move(writing_.front());
    writing_.pop_front();
    try {
      oldest.images.get();
    } catch (const Error&) {
      drop(oldest);
      for (; !writing_.empty(); writing_.pop_front()) drop(writing_.front());
      throw;
    }
    list(oldest);
  }
}

void SequenceWriter::list(const Frame& frame) {
  const std::string& stamp = frame.stamp;
  rgb_ += fmt::format("{0} rgb/{0}.png\n", stamp);
  depth_ += fmt::format("{0} depth/{0}.png\n", stamp);
  associations_ += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", stamp);
  detections_ += frame.detections;
  stamps_.push_back(frame.timestamp);
}

void SequenceWriter::drop(const Frame& frame) const {
  if (frame.images.valid()) frame.images.wait();
  std::error_code ignored;
  for (const char* folder : image_folders)
    fs::remove(image_file(out_, folder, frame.stamp), ignored);
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
