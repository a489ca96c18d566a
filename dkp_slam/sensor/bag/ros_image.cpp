#include "dkp_slam/sensor/bag/ros_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/image_reader.h"

namespace dkp_slam {
namespace {

constexpr std::uint64_t most_pixels = 64'000'000;

struct ColourEncoding {
  const char* name;
  int type;        // of the pixels as they lie there
  int conversion;  // to BGR; -1 for none
};

constexpr ColourEncoding colour_encodings[] = {
    {"bgr8", CV_8UC3, -1},
    {"8UC3", CV_8UC3, -1},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
    {"8UC4", CV_8UC4, cv::COLOR_BGRA2BGR},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2BGR},
    {"8UC1", CV_8UC1, cv::COLOR_GRAY2BGR},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
    {"UYVY", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
    {"YUYV", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
    // OpenCV names a pattern by the second row's second and third pixel.
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
};

/// The message's pixels, not copied.
cv::Mat pixels_of(const RosImage& image, int type) {
  const std::uint64_t row = static_cast<std::uint64_t>(image.width) * CV_ELEM_SIZE(type);
  const std::uint64_t pixels = static_cast<std::uint64_t>(image.width) * image.height;
  const bool whole_numbers = image.step % CV_ELEM_SIZE1(type) == 0;
  if (pixels == 0 || pixels > most_pixels || image.step < row || !whole_numbers ||
      image.data.size() < static_cast<std::uint64_t>(image.step) * image.height) {
    throw Error(fmt::format("{} bytes are no image of {} x {} pixels in {}, {} bytes a row",
                            image.data.size(), image.width, image.height, image.encoding,
                            image.step));
  }
  return {static_cast<int>(image.height), static_cast<int>(image.width), type,
          const_cast<std::uint8_t*>(image.data.data()), image.step};
}

/// As it was packed: PNG or JPEG.
cv::Mat unpacked(std::span<const std::uint8_t> data, const std::string& format) {
  const ImageRead read = ImageReader(most_pixels).unchanged_of(data);
  if (read.image.empty()) {
    throw Error(fmt::format("its image (\"{}\") is damaged: {}", format, read.problem));
  }
  return read.image;
}

void swap_bytes(cv::Mat& words) {
  for (int y = 0; y < words.rows; ++y) {
    auto* row = words.ptr<std::uint16_t>(y);
    for (int x = 0; x < words.cols; ++x)
      row[x] = static_cast<std::uint16_t>(row[x] << 8 | row[x] >> 8);
  }
}

void zero_unknown(cv::Mat& metres) {
  keep_depth_range(metres, 0.0, std::numeric_limits<float>::max());
}

/// The head that compressed_depth_image_transport puts before a PNG.
struct DepthHead {
  std::int32_t format = 0;
  float a = 0.0F, b = 0.0F;  // of float depth: metres = a / (pixel - b)
};

cv::Mat packed_depth(const RosImage& image, double units_per_metre) {
  if (image.data.size() <= sizeof(DepthHead)) throw Error("its compressed depth is cut off");
  DepthHead head;
  std::memcpy(&head, image.data.data(), sizeof(head));
  const cv::Mat raw = unpacked(image.data.subspan(sizeof(head)), image.encoding);
  if (raw.type() != CV_16UC1) {
    throw Error(fmt::format("its compressed depth (\"{}\") is no 16-bit PNG", image.encoding));
  }
  if (!image.encoding.starts_with("32FC1")) {
    return depth_in_metres(raw, units_per_metre, 0.0, std::numeric_limits<float>::max());
  }
  cv::Mat metres(raw.size(), CV_32FC1);
  for (int y = 0; y < raw.rows; ++y) {
    const auto* in = raw.ptr<std::uint16_t>(y);
    auto* out = metres.ptr<float>(y);
    for (int x = 0; x < raw.cols; ++x) {
      out[x] = in[x] == 0 ? 0.0F : head.a / (static_cast<float>(in[x]) - head.b);
    }
  }
  zero_unknown(metres);
  return metres;
}

}  // namespace

cv::Mat colour_of(const RosImage& image) {
  if (image.compressed) {
    cv::Mat unpacked_image = unpacked(image.data, image.encoding);
    if (unpacked_image.type() == CV_8UC3) return unpacked_image;
    if (unpacked_image.type() != CV_8UC1) throw Error("its image has 16 bits a channel");
    cv::Mat bgr;
    cv::cvtColor(unpacked_image, bgr, cv::COLOR_GRAY2BGR);
    return bgr;
  }
  for (const ColourEncoding& known : colour_encodings) {
    if (image.encoding != known.name) continue;
    const cv::Mat pixels = pixels_of(image, known.type);
    if (known.conversion < 0) return pixels.clone();
    cv::Mat bgr;
    if (known.type == CV_8UC2 && image.width % 2 != 0) {
      throw Error(
          fmt::format("an image in {} cannot be {} pixels wide", image.encoding, image.width));
    }
    cv::cvtColor(pixels, bgr, known.conversion);
    return bgr;
  }
  throw Error(fmt::format(
      "its encoding \"{}\" is not known for colour; bgr8, rgb8, bgra8, rgba8, mono8, yuv422, "
      "yuv422_yuy2, bayer_...8 and compressed ones are",
      image.encoding));
}

cv::Mat depth_of(const RosImage& image, double units_per_metre) {
  if (image.compressed) {
    if (image.encoding.find("compressedDepth") == std::string::npos) {
      throw Error(fmt::format(
          "its format \"{}\" is not known for depth; compressedDepth with PNG is", image.encoding));
    }
    return packed_depth(image, units_per_metre);
  }
  const bool foreign = image.big_endian != (std::endian::native == std::endian::big);
  if (image.encoding == "16UC1" || image.encoding == "mono16") {
    cv::Mat raw = pixels_of(image, CV_16UC1).clone();  // a message's pixels lie at any address
    if (foreign) swap_bytes(raw);
    return depth_in_metres(raw, units_per_metre, 0.0, std::numeric_limits<float>::max());
  }
  if (image.encoding == "32FC1" && !foreign) {
    cv::Mat metres = pixels_of(image, CV_32FC1).clone();
    zero_unknown(metres);
    return metres;
  }
  throw Error(
      fmt::format("its encoding \"{}\"{} is not known for depth; 16UC1, mono16 and 32FC1 are",
                  image.encoding, foreign ? ", big-endian," : ""));
}

Camera camera_of(const RosCameraInfo& info, bool rectified) {
  Camera camera;
  camera.width = static_cast<int>(std::min<std::uint32_t>(info.width, 1U << 20U));
  camera.height = static_cast<int>(std::min<std::uint32_t>(info.height, 1U << 20U));
  constexpr double millimetres = 1000.0;  // 16UC1, by ROS's convention
  camera.depth_scale = millimetres;
  if (rectified && info.p[0] != 0.0) {
    camera.fx = info.p[0], camera.fy = info.p[5], camera.cx = info.p[2], camera.cy = info.p[6];
  } else {
    camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  }
  const auto zero = [](double value) { return value == 0.0; };
  if (!rectified && !std::all_of(info.d.begin(), info.d.end(), zero)) {
    // Of rational_polynomial the first five are the same.
    const bool rational = info.distortion_model == "rational_polynomial" && info.d.size() >= 5 &&
                          std::all_of(info.d.begin() + 5, info.d.end(), zero);
    const bool plumb_bob = (info.distortion_model == "plumb_bob" || info.distortion_model.empty() ||
                            info.distortion_model == "Brown Conrady") &&
                           (info.d.size() == 4 || info.d.size() == 5);
    if (!rational && !plumb_bob) {
      throw Error(
          fmt::format("its distortion model \"{}\" with {} coefficients is not known, plumb_bob is",
                      info.distortion_model, info.d.size()));
    }
    camera.distortion = {info.d[0], info.d[1], info.d[2], info.d[3],
                         info.d.size() > 4 ? info.d[4] : 0.0};
  }
  if (const auto problem = camera.check()) throw Error(*problem);
  return camera;
}

}  // namespace dkp_slam
