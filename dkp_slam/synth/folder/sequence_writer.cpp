#include "dkp_slam/synth/folder/sequence_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/synth/true_detections.h"

namespace dkp_slam {
namespace {

namespace fs = std::filesystem;

constexpr std::array image_folders = {"rgb", "depth", "mask", "instances"};

fs::path image_file(const fs::path& out, const char* folder, const std::string& stamp) {
  return out / folder / (stamp + ".png");
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
  writing_.collect(OrderedWork::cores() - 1);
  const std::string stamp = fmt::format("{:.6f}", frame.timestamp);
  const auto write = [this, stamp, frame, truth] {
    cv::Mat units;
    frame.depth.convertTo(units, CV_16U, depth_scale_);
    const std::array images = {frame.colour, units, truth.mask, truth.instance};
    for (std::size_t i = 0; i < images.size(); ++i) {
      write_image(image_file(out_, image_folders[i], stamp), images[i]);
    }
  };
  const Listed listed{frame.timestamp, stamp,
                      recorded_lines(frame.timestamp, true_detections(truth))};
  writing_.add({write, [this, listed] { list(listed); }, [this, stamp] { drop(stamp); }});
}

void SequenceWriter::list(const Listed& frame) {
  const std::string& stamp = frame.stamp;
  rgb_ += fmt::format("{0} rgb/{0}.png\n", stamp);
  depth_ += fmt::format("{0} depth/{0}.png\n", stamp);
  associations_ += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", stamp);
  detections_ += frame.detections;
  stamps_.push_back(frame.timestamp);
}

void SequenceWriter::drop(const std::string& stamp) const {
  std::error_code ignored;
  for (const char* folder : image_folders) fs::remove(image_file(out_, folder, stamp), ignored);
}

void SequenceWriter::finish(const SyntheticSource& source) {
  writing_.collect(0);
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

}  // namespace dkp_slam
