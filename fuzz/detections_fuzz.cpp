// Recorded detections.
#include <cmath>
#include <cstdlib>

#include "dkp_slam/detection/recorded_detector.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void check(const std::vector<Detection>& detections, const cv::Size& size) {
  const cv::Rect2f image(0.0F, 0.0F, static_cast<float>(size.width),
                         static_cast<float>(size.height));
  for (const Detection& d : detections) {
    require(d.score >= 0.0F && d.score <= 1.0F, "a score that is no probability");
    require(d.box.area() > 0.0F && (d.box & image) == d.box, "a box outside the image");
    require(d.weight >= 1.0F && d.weight <= 10.0F, "a weight out of bounds");
  }
}

void run(Bytes bytes) {
  const InputFile file(bytes);
  const std::string text = text_of(bytes);
  takes([&] {
    const auto detector = open_recorded_detections(file.path(), ClassTable());
    RgbdFrame frame;
    frame.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(0));
    for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
      frame.timestamp = std::strtod(text.c_str() + line, nullptr);
      const std::vector<Detection> found = detector->detect(frame);
      check(found, frame.colour.size());
      // What a run writes is read again.
      if (std::isfinite(frame.timestamp)) {
        const std::string written = recorded_header() + recorded_lines(frame.timestamp, found);
        const InputFile again(bytes_of(written));
        require(open_recorded_detections(again.path(), ClassTable())->detect(frame).size() ==
                    found.size(),
                "written and read there are more or fewer");
      }
      if (text.find('\n', line) == std::string::npos) break;
    }
  });
}

std::vector<std::string> seeds() {
  return {"# timestamp class_id score x y width height\n1.5 0 0.9 3 4 20 30\n1.5 -2 0.25 0 0 5 5\n",
          "1e9 79 1 -5 -5 100.5 1e3\n2 56 0.5 1e30 2 3 4\r\n"};
}

const Registration registration({"detections", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
