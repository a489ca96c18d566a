// Image files as the reader takes them: colour, depth, masks, of any kind and none.
#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/sensor/image_reader.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void check(const ImageRead& read) {
  require(read.image.empty() != read.problem.empty(), "an image and a problem, or neither");
}

void run(Bytes bytes) {
  const InputFile file(bytes);
  static ImageReader reader(1'000'000);
  const ImageRead colour = reader.read_colour(file.path());
  check(colour);
  require(colour.image.empty() || colour.image.type() == CV_8UC3, "colour of another type");
  const ImageRead mask = reader.read_grey_png(file.path());
  check(mask);
  require(mask.image.empty() || mask.image.type() == CV_8UC1, "a mask of another type");
  const ImageRead depth = reader.read_unchanged(file.path());
  check(depth);
  if (depth.image.type() != CV_16UC1 || depth.image.empty()) return;
  const cv::Mat metres = depth_in_metres(depth.image, 5000.0, 0.1, 10.0);
  const cv::Mat known = metres > 0.0F;
  require(cv::countNonZero(known & (metres < 0.0999F)) == 0, "depth below the camera's range");
}

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  const auto add = [&all](const char* kind, const cv::Mat& image) {
    std::vector<std::uint8_t> file;
    cv::imencode(kind, image, file);
    all.emplace_back(file.begin(), file.end());
  };
  cv::Mat colour(16, 24, CV_8UC3), depth(16, 24, CV_16UC1), alpha(8, 8, CV_8UC4);
  cv::RNG random(1);
  for (cv::Mat* image : {&colour, &depth, &alpha}) random.fill(*image, cv::RNG::UNIFORM, 0, 255);
  add(".jpg", colour);
  for (const char* kind : {".png", ".bmp", ".tiff", ".ppm", ".webp"}) add(kind, colour);
  add(".png", depth);
  add(".png", alpha);
  add(".tiff", depth);
  return all;
}

const Registration registration({"image", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
