#include "tests/support/recording.h"

#include <fstream>
#include <istream>
#include <ostream>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/measure/child_process.h"
#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::testing {
namespace {

namespace fs = std::filesystem;

// Values as they lie in memory: the file is for other programs of the same build.
template <class Value>
void put(std::ostream& out, const Value& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

template <class Value>
Value get(std::istream& in) {
  Value value{};
  in.read(reinterpret_cast<char*>(&value), sizeof(value));
  return value;
}

void put_image(std::ostream& out, const cv::Mat& image) {
  for (const int n : {image.rows, image.cols, image.type()}) put(out, n);
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  out.write(reinterpret_cast<const char*>(whole.data),
            static_cast<std::streamsize>(whole.total() * whole.elemSize()));
}

cv::Mat get_image(std::istream& in) {
  const int rows = get<int>(in), columns = get<int>(in), type = get<int>(in);
  cv::Mat image(rows, columns, type);
  in.read(reinterpret_cast<char*>(image.data),
          static_cast<std::streamsize>(image.total() * image.elemSize()));
  return image;
}

void put_text(std::ostream& out, const std::string& text) {
  put(out, text.size());
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

std::string get_text(std::istream& in) {
  std::string text(get<std::size_t>(in), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

void put_pose(std::ostream& out, const Se3& pose) {
  for (const double v : pose.rotation.coeffs()) put(out, v);
  for (const double v : pose.translation) put(out, v);
}

Se3 get_pose(std::istream& in) {
  Se3 pose;
  for (double& v : pose.rotation.coeffs()) v = get<double>(in);
  for (double& v : pose.translation) v = get<double>(in);
  return pose;
}

void put_objects(std::ostream& out, const std::vector<SyntheticObject>& objects) {
  put(out, objects.size());
  for (const SyntheticObject& object : objects) {
    put(out, object.instance);
    put_text(out, object.class_name);
    for (const int n : {object.box.x, object.box.y, object.box.width, object.box.height}) {
      put(out, n);
    }
    put(out, object.pixels);
  }
}

std::vector<SyntheticObject> get_objects(std::istream& in) {
  std::vector<SyntheticObject> objects(get<std::size_t>(in));
  for (SyntheticObject& object : objects) {
    object.instance = get<int>(in);
    object.class_name = get_text(in);
    for (int* n : {&object.box.x, &object.box.y, &object.box.width, &object.box.height}) {
      *n = get<int>(in);
    }
    object.pixels = get<int>(in);
  }
  return objects;
}

}  // namespace

Recording::Recording(const std::string& scenario, std::size_t length, std::size_t first_frame,
                     int divisor)
    : camera(smaller(SyntheticOptions::default_camera(), divisor)) {
  const fs::path log =
      fs::path(::testing::TempDir()) / fmt::format("dkp_slam_recording.{}.log", ::getpid());
  const ProcessResult result =
      run_process({DKP_SLAM_RECORDING_PROGRAM, DKP_SLAM_RECORDING_FOLDER, scenario,
                   std::to_string(length), std::to_string(first_frame), std::to_string(divisor)},
                  log);
  const std::string said = last_line(log);
  fs::remove(log);
  if (result.exit_code != 0) throw Error("recording " + scenario + ": " + said);
  load(said, length);
}

Recording::Recording(const std::string& scenario, const Camera& seen_by, std::size_t length,
                     std::size_t first_frame)
    : camera(seen_by) {
  SyntheticOptions options = synthetic_scenario(scenario);
  options.frames = length;
  options.first_frame = first_frame;
  options.camera = camera;
  SyntheticSource world(options);
  while (auto frame = world.read()) {
    truth.push_back({frame->timestamp, world.truth().world_from_camera});
    truths.push_back(world.truth());
    truths.back().depth.release();
    frames.push_back(std::move(*frame));
  }
}

void Recording::save(const fs::path& file) const {
  write_file_atomically(file, [this](std::ostream& out) {
    put(out, frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      put(out, frames[i].timestamp);
      put_pose(out, truths[i].world_from_camera);
      for (const cv::Mat& image : {frames[i].colour, frames[i].depth, truths[i].instance}) {
        put_image(out, image);
      }
      put_objects(out, truths[i].objects);
    }
  });
}

std::size_t Recording::length_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return get<std::size_t>(in);
}

void Recording::load(const fs::path& file, std::size_t length) {
  std::ifstream in(file, std::ios::binary);
  const auto held = get<std::size_t>(in);
  for (std::size_t i = 0; i < length && i < held; ++i) {
    RgbdFrame& frame = frames.emplace_back();
    SyntheticTruth& exact = truths.emplace_back();
    frame.index = static_cast<int>(i);
    frame.timestamp = get<double>(in);
    exact.world_from_camera = get_pose(in);
    frame.colour = get_image(in);
    frame.depth = get_image(in);
    exact.instance = get_image(in);
    exact.mask = cv::Mat(exact.instance != 0);
    exact.objects = get_objects(in);
    truth.push_back({frame.timestamp, exact.world_from_camera});
  }
  if (!in || frames.size() != length) {
    throw Error(
        fmt::format("{}: not {} frames; remove the file and try again", file.string(), length));
  }
}

}  // namespace dkp_slam::testing
