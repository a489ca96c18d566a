// Images and cameras of ROS messages, as bags and the node bring them.
#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/sensor/bag/ros_image.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

const char* const encodings[] = {"bgr8",
                                 "rgb8",
                                 "bgra8",
                                 "rgba8",
                                 "mono8",
                                 "8UC1",
                                 "8UC3",
                                 "8UC4",
                                 "yuv422",
                                 "yuv422_yuy2",
                                 "bayer_rggb8",
                                 "bayer_bggr8",
                                 "bayer_gbrg8",
                                 "bayer_grbg8",
                                 "16UC1",
                                 "mono16",
                                 "32FC1",
                                 "jpeg",
                                 "8UC5",
                                 "16UC1; compressedDepth png",
                                 "32FC1; compressedDepth png"};

void check_colour(const RosImage& image) {
  takes([&] {
    const cv::Mat colour = colour_of(image);
    require(colour.type() == CV_8UC3 && !colour.empty(), "colour of another type");
    require(image.compressed || (colour.cols == static_cast<int>(image.width) &&
                                 colour.rows == static_cast<int>(image.height)),
            "colour of another size");
  });
}

void check_depth(const RosImage& image) {
  takes([&] {
    const cv::Mat depth = depth_of(image, 1000.0);
    require(depth.type() == CV_32FC1 && !depth.empty(), "depth of another type");
    require(std::all_of(depth.begin<float>(), depth.end<float>(),
                        [](float metres) { return std::isfinite(metres) && metres >= 0.0F; }),
            "depth that is none");
  });
}

void check_camera(Reader& input) {
  RosCameraInfo info;
  info.width = input.take<std::uint16_t>();
  info.height = input.take<std::uint16_t>();
  const bool rectified = input.below(2) == 1;
  info.distortion_model = input.below(2) == 1 ? "plumb_bob" : "rational_polynomial";
  info.d.resize(static_cast<std::size_t>(input.below(10)));
  for (double& value : info.d) value = input.take<double>();
  for (double& value : info.k) value = input.take<double>();
  for (double& value : info.p) value = input.take<double>();
  takes([&] { require(!camera_of(info, rectified).check(), "a camera that was taken is none"); });
}

void run(Bytes bytes) {
  Reader input(bytes);
  const std::size_t kind = input.take<std::uint8_t>();
  if (kind >= std::size(encodings)) return check_camera(input);
  RosImage image;
  image.encoding = encodings[kind];
  image.width = input.take<std::uint32_t>();
  image.height = input.take<std::uint32_t>();
  image.step = input.take<std::uint32_t>();
  image.compressed = input.below(2) == 1;
  image.big_endian = input.below(2) == 1;
  image.data = input.rest();
  // Of what is packed a few bytes stand for as many pixels as they like; that is `image`'s.
  constexpr std::uint64_t most = 1'000'000;
  if (std::uint64_t{image.width} * image.height > most) return;
  check_colour(image);
  check_depth(image);
}

template <class Value>
void put(std::string& text, Value value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string message(std::uint8_t kind, std::uint32_t width, std::uint32_t height,
                    std::uint32_t step, bool compressed, const std::string& data) {
  std::string text;
  put(text, kind);
  put(text, width);
  put(text, height);
  put(text, step);
  put(text, compressed);
  put(text, false);
  return text + data;
}

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  const std::uint32_t pixel_bytes[] = {3, 3, 4, 4, 1, 1, 3, 4, 2, 2, 1, 1, 1, 1, 2, 2, 4};
  for (std::uint8_t kind = 0; kind < std::size(pixel_bytes); ++kind) {
    const std::uint32_t step = 6 * pixel_bytes[kind];
    all.push_back(message(kind, 6, 4, step, false, std::string(std::size_t{4} * step, 'a')));
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)), png);
  std::string depth(sizeof(std::int32_t), '\0');
  put(depth, 100.0F);
  put(depth, 1400.0F);
  depth.append(png.begin(), png.end());
  all.push_back(message(19, 0, 0, 0, true, depth));
  all.push_back(message(20, 0, 0, 0, true, depth));
  std::string camera;
  put<std::uint8_t>(camera, 255);
  put<std::uint16_t>(camera, 640);
  put<std::uint16_t>(camera, 480);
  camera += std::string("\0\1\5", 3);
  for (const double value : {0.1, -0.2, 0.0, 0.0,   0.0, 525.0, 0.0, 319.5, 0.0,   525.0, 239.5,
                             0.0, 0.0,  1.0, 525.0, 0.0, 319.5, 0.0, 0.0,   525.0, 239.5}) {
    put(camera, value);
  }
  all.push_back(camera);
  return all;
}

const Registration registration({"ros_image", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
