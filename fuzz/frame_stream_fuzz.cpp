// Frame streams, as a driver writes them into a pipe.
#include <cmath>
#include <limits>

#include <unistd.h>

#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/stream/stream_source.h"
#include "dkp_slam/sensor/stream/test_driver.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

constexpr std::size_t most_pixels = 65536;

/// Larger images are good ones and slow.
bool is_large(Bytes bytes) {
  if (bytes.size() < stream::header_bytes) return false;
  Reader input(bytes);
  bool large = false;
  takes([&] {
    const auto bytes_of_header = input.take<std::array<char, stream::header_bytes>>();
    large = stream::parse_header(bytes_of_header).pixels() > most_pixels;
  });
  return large;
}

void run(Bytes bytes) {
  if (is_large(bytes)) return;
  const InputFile file(bytes);
  if (dup2(file.descriptor(), STDIN_FILENO) < 0) throw std::runtime_error("no standard input");
  StreamOptions options;
  options.masks = true;
  takes([&] {
    const auto source = open_stream(StreamAddress(), options);
    if (source->own_camera()) source->use_camera(*source->own_camera());
    double last = -std::numeric_limits<double>::infinity();
    while (const auto frame = source->read()) {
      require(frame->timestamp > last, "time stamps that do not rise");
      last = frame->timestamp;
      require(frame->colour.type() == CV_8UC3 && frame->depth.type() == CV_32FC1 &&
                  frame->colour.size() == frame->depth.size(),
              "images of another type or size");
      require(frame->mask.empty() || frame->mask.size() == frame->colour.size(),
              "a mask too small");
      require(cv::countNonZero(frame->depth != frame->depth) == 0, "depth that is no number");
    }
  });
}

std::vector<std::string> seeds() {
  using testing::frame_of, testing::end_of_stream;
  stream::Header header;
  header.width = 8;
  header.height = 4;
  const cv::Mat colour(4, 8, CV_8UC3, cv::Scalar(1, 2, 3)), units(4, 8, CV_16UC1, cv::Scalar(5000));
  const cv::Mat mask(4, 8, CV_8UC1, cv::Scalar(255));
  Camera camera;
  camera.width = 8;
  camera.height = 4;
  camera.fx = camera.fy = 8.0;
  camera.cx = 3.5;
  camera.cy = 1.5;
  std::vector<std::string> all{testing::header_of(header, camera_text(camera)) +
                               frame_of(1.0, colour, units) + frame_of(2.0, colour, units, mask) +
                               end_of_stream()};
  header.colour = stream::ColourFormat::grey8;
  header.depth = stream::DepthFormat::f32;
  const cv::Mat grey(4, 8, CV_8UC1, cv::Scalar(7));
  const cv::Mat metres(4, 8, CV_32FC1, cv::Scalar(std::nan("")));
  all.push_back(testing::header_of(header, "") + frame_of(1.0, grey, metres, {}, 0.01) +
                frame_of(0.5, grey, metres) + end_of_stream());
  return all;
}

const Registration registration({"frame_stream", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
