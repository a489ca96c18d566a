#include <algorithm>
#include <array>
#include <vector>

#include <onnxruntime_cxx_api.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/detection/yolox/yolox_model.h"
#include "dkp_slam/detection/yolox/yolox_network.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

/// ONNX Runtime's own messages go to our log: by default it writes wherever it likes.
void ORT_API_CALL forward_log(void*, OrtLoggingLevel level, const char*, const char*, const char*,
                              const char* message) {
  spdlog::log(level >= ORT_LOGGING_LEVEL_ERROR ? spdlog::level::err : spdlog::level::debug,
              "ONNX Runtime: {}", message);
}

Ort::Env& environment() {
  // One per process, as ONNX Runtime asks.
  static Ort::Env env(ORT_LOGGING_LEVEL_ERROR, "dkp-slam", forward_log, nullptr);
  return env;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Adds the wanted provider and returns the name of the one that will run.
std::string choose_provider(const std::string& wanted, Ort::SessionOptions& session_options) {
  if (wanted == "cpu") return "cpu";
  const std::string full_name = wanted == "cuda"       ? "CUDAExecutionProvider"
                                : wanted == "tensorrt" ? "TensorrtExecutionProvider"
                                                       : "";
  if (full_name.empty()) {
    throw Error("unknown execution provider '" + wanted + "'; use cpu, cuda or tensorrt");
  }
  const std::vector<std::string> available = Ort::GetAvailableProviders();
  if (std::find(available.begin(), available.end(), full_name) == available.end()) {
    spdlog::warn("the installed ONNX Runtime has no provider '{}'; detection runs on the cpu",
                 wanted);
    return "cpu";
  }
  try {
    if (wanted == "cuda") {
      session_options.AppendExecutionProvider_CUDA(OrtCUDAProviderOptions{});
    } else {
      session_options.AppendExecutionProvider_TensorRT(OrtTensorRTProviderOptions{});
    }
  } catch (const Ort::Exception& error) {
    spdlog::warn("the provider '{}' does not start ({}); detection runs on the cpu", wanted,
                 first_line(error.what()));
    return "cpu";
  }
  return wanted;
}

class OnnxNetwork : public YoloxNetwork {
 public:
  OnnxNetwork(const YoloxOptions& options, const std::string& bytes) {
    Ort::SessionOptions session_options;
    session_options.SetIntraOpNumThreads(options.threads);
    session_options.SetInterOpNumThreads(1);
    session_options.SetExecutionMode(ORT_SEQUENTIAL);
    session_options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
    // Idle threads must not spin: tracking and mapping share the cores.
    session_options.AddConfigEntry("session.intra_op.allow_spinning", "0");
    session_options.AddConfigEntry("session.inter_op.allow_spinning", "0");
    provider_ = choose_provider(options.provider, session_options);
    try {
      session_ = Ort::Session(environment(), bytes.data(), bytes.size(), session_options);
    } catch (const Ort::Exception& error) {
      throw Error("'" + options.model.string() + "' is not a model that ONNX Runtime can load (" +
                  first_line(error.what()) +
                  "); use an official YOLOX export (scripts/fetch_model.sh)");
    }
    bind(options.model.string());
  }

  std::string name() const override { return "ONNX Runtime, " + provider_; }
  cv::Size input_size() const override { return size_; }
  float* input() override { return input_.data(); }

  const float* run() override {
    const char* input_name = input_name_.c_str();
    const char* output_name = output_name_.c_str();
    try {
      session_.Run(Ort::RunOptions{nullptr}, &input_name, &input_tensor_, 1, &output_name,
                   &output_tensor_, 1);
    } catch (const Ort::Exception& error) {
      throw Error("ONNX Runtime failed on the detection model: " + first_line(error.what()));
    }
    return output_.data();
  }

 private:
  /// Checks the shapes and lays tensors over our own buffers, so that a run allocates nothing.
  void bind(const std::string& model) {
    const auto shape = [](const Ort::TypeInfo& info) {
      if (info.GetONNXType() != ONNX_TYPE_TENSOR ||
          info.GetTensorTypeAndShapeInfo().GetElementType() !=
              ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT) {
        return std::vector<std::int64_t>{};
      }
      return info.GetTensorTypeAndShapeInfo().GetShape();
    };
    if (session_.GetInputCount() != 1 || session_.GetOutputCount() != 1) {
      throw Error("'" + model + "' is not a YOLOX model: it has " +
                  std::to_string(session_.GetInputCount()) + " inputs and " +
                  std::to_string(session_.GetOutputCount()) +
                  " outputs, not one of each; use an official YOLOX export "
                  "(scripts/fetch_model.sh)");
    }
    size_ = yolox::check_shapes(model, shape(session_.GetInputTypeInfo(0)),
                                shape(session_.GetOutputTypeInfo(0)));
    Ort::AllocatorWithDefaultOptions allocator;
    input_name_ = session_.GetInputNameAllocated(0, allocator).get();
    output_name_ = session_.GetOutputNameAllocated(0, allocator).get();
    const std::array<std::int64_t, 4> input_shape{1, 3, size_.height, size_.width};
    const std::array<std::int64_t, 3> output_shape{1, yolox::row_count(size_), yolox::row_length};
    input_.assign(3 * static_cast<std::size_t>(size_.area()), yolox::padding);
    output_.assign(static_cast<std::size_t>(output_shape[1] * output_shape[2]), 0.0F);
    const auto memory = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
    input_tensor_ = Ort::Value::CreateTensor<float>(memory, input_.data(), input_.size(),
                                                    input_shape.data(), input_shape.size());
    output_tensor_ = Ort::Value::CreateTensor<float>(memory, output_.data(), output_.size(),
                                                     output_shape.data(), output_shape.size());
  }

  Ort::Session session_{nullptr};
  std::string provider_, input_name_, output_name_;
  cv::Size size_;
  std::vector<float> input_, output_;
  Ort::Value input_tensor_{nullptr}, output_tensor_{nullptr};
};

}  // namespace

std::unique_ptr<YoloxNetwork> load_yolox_onnxruntime(const YoloxOptions& options,
                                                     const std::string& model) {
  return std::make_unique<OnnxNetwork>(options, model);
}

}  // namespace dkp_slam
