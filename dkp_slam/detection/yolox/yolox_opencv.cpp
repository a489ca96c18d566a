#include <array>
#include <sstream>
#include <vector>

#include <opencv2/dnn.hpp>

#include "dkp_slam/detection/yolox/onnx_shapes.h"
#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/detection/yolox/yolox_model.h"
#include "dkp_slam/detection/yolox/yolox_network.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// OpenCV's error text in one line; it spans several where a check failed.
std::string one_line(const cv::Exception& error) {
  std::istringstream words(error.err);
  std::string line, word;
  while (words >> word) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// A free dimension (the batch) becomes 1.
cv::dnn::MatShape to_dnn(const std::vector<std::int64_t>& shape) {
  cv::dnn::MatShape dimensions;
  for (std::int64_t d : shape) dimensions.push_back(d < 0 ? 1 : static_cast<int>(d));
  return dimensions;
}

class OpenCvNetwork : public YoloxNetwork {
 public:
  OpenCvNetwork(const YoloxOptions& options, const std::string& bytes) {
    const std::string model = options.model.string();
    std::vector<std::int64_t> output_shape;
    const std::vector<std::int64_t> input_shape = onnx_input_shape(bytes);
    try {
      network_ = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
      const std::vector<int> last = network_.getUnconnectedOutLayers();
      std::vector<cv::dnn::MatShape> inputs, outputs;
      if (input_shape.size() == 4 && last.size() == 1) {
        network_.getLayerShapes(to_dnn(input_shape), last[0], inputs, outputs);
        if (outputs.size() == 1) output_shape.assign(outputs[0].begin(), outputs[0].end());
      }
    } catch (const cv::Exception& error) {
      throw Error("'" + model + "' is not a model that OpenCV can load (" + one_line(error) +
                  "); use an official YOLOX export (scripts/fetch_model.sh)");
    }
    size_ = yolox::check_shapes(model, input_shape, output_shape);
    network_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    network_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    const std::array<int, 4> blob{1, 3, size_.height, size_.width};
    input_ = cv::Mat(4, blob.data(), CV_32F, cv::Scalar(yolox::padding));
  }

  std::string name() const override { return "OpenCV dnn, cpu"; }
  cv::Size input_size() const override { return size_; }
  float* input() override { return input_.ptr<float>(); }

  const float* run() override {
    try {
      network_.setInput(input_);
      output_ = network_.forward();
    } catch (const cv::Exception& error) {
      throw Error("OpenCV failed on the detection model: " + one_line(error));
    }
    if (output_.total() != static_cast<std::size_t>(yolox::row_count(size_)) * yolox::row_length) {
      throw Error("OpenCV's dnn gave an output of an unexpected size for the detection model");
    }
    return output_.ptr<float>();
  }

 private:
  cv::dnn::Net network_;
  cv::Size size_;
  cv::Mat input_, output_;
};

}  // namespace

std::unique_ptr<YoloxNetwork> load_yolox_opencv(const YoloxOptions& options,
                                                const std::string& model) {
  return std::make_unique<OpenCvNetwork>(options, model);
}

}  // namespace dkp_slam
