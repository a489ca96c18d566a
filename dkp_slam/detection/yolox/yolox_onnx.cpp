#include <algorithm>
#include <array>
#include <vector>

#include <onnxruntime_cxx_api.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/detection/yolox/onnx_focus.h"
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
  // One per process, as ONNX Runtime asks. It is never released: with CUDA that breaks the heap at
  // exit ("corrupted double-linked list", ONNX Runtime 1.18 to 1.29), after all is done.
  static Ort::Env& env = *new Ort::Env(ORT_LOGGING_LEVEL_ERROR, "dkp-slam", forward_log, nullptr);
  return env;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// What went wrong, without ONNX Runtime's own functions before it and its source lines after it.
std::string reason(const Ort::Exception& error) {
  std::string line = first_line(error.what());
  for (const std::string mark : {" : FAIL : ", "] "}) {
    if (const auto at = line.rfind(mark); at != std::string::npos) line.erase(0, at + mark.size());
  }
  return line.substr(0, line.find(" ; "));
}

/// Whether the installed ONNX Runtime knows the provider; a warning says where it does not.
bool has_provider(const std::string& wanted) {
  if (wanted == "cpu") return true;
  const std::string full_name = wanted == "cuda"       ? "CUDAExecutionProvider"
                                : wanted == "tensorrt" ? "TensorrtExecutionProvider"
                                                       : "";
  if (full_name.empty()) {
    throw Error("unknown execution provider '" + wanted + "'; use cpu, cuda or tensorrt");
  }
  const std::vector<std::string> available = Ort::GetAvailableProviders();
  if (std::find(available.begin(), available.end(), full_name) != available.end()) return true;
  spdlog::warn("the installed ONNX Runtime has no provider '{}'; detection runs on the cpu",
               wanted);
  return false;
}

/// Adds the provider; throws Ort::Exception where it lacks a library.
void add_provider(const std::string& wanted, Ort::SessionOptions& session_options) {
  if (wanted == "tensorrt") {
    Ort::TensorRTProviderOptions tensorrt;
    tensorrt.Update({{"device_id", "0"}});  // loads it, so that what it lacks is said
    session_options.AppendExecutionProvider_TensorRT_V2(*tensorrt);
  }
  if (wanted != "cpu") {  // with TensorRT: what that does not take
    Ort::CUDAProviderOptions cuda;
    // TF32 is no faster with a network this small (H200), and moves scores by up to .02; without it
    // they are the CPU's to 5 digits. Trying every algorithm only makes the start longer.
    cuda.Update({{"use_tf32", "0"}, {"cudnn_conv_algo_search", "HEURISTIC"}});
    session_options.AppendExecutionProvider_CUDA_V2(*cuda);
  }
}

class OnnxNetwork : public YoloxNetwork {
 public:
  OnnxNetwork(const YoloxOptions& options, const std::string& model) {
    const std::string dealt = onnx_without_focus(model);
    const std::string& bytes = dealt.empty() ? model : dealt;
    if (!dealt.empty()) layout_ = yolox::InputLayout::phases;
    provider_ = has_provider(options.provider) ? options.provider : "cpu";
    if (provider_ != "cpu") {
      // What it lacks shows here (a library), when the session is made (a device) or in the first
      // run (memory, kernels).
      try {
        open(options, bytes);
        bind(options.model.string());
        run_session();
        return;
      } catch (const Ort::Exception& error) {
        spdlog::warn("the provider '{}' does not start ({}); detection runs on the cpu", provider_,
                     reason(error));
        provider_ = "cpu";
      }
    }
    try {
      open(options, bytes);
    } catch (const Ort::Exception& error) {
      throw Error("'" + options.model.string() + "' is not a model that ONNX Runtime can load (" +
                  first_line(error.what()) +
                  "); use an official YOLOX export (scripts/fetch_model.sh)");
    }
    bind(options.model.string());
  }

  std::string name() const override { return "ONNX Runtime, " + provider_; }
  cv::Size input_size() const override { return size_; }
  yolox::InputLayout layout() const override { return layout_; }
  float* input() override { return input_.data(); }

  const float* run() override {
    try {
      run_session();
    } catch (const Ort::Exception& error) {
      throw Error("ONNX Runtime failed on the detection model: " + first_line(error.what()));
    }
    return output_.data();
  }

 private:
  void open(const YoloxOptions& options, const std::string& bytes) {
    // Before a provider is added: loading one writes to the environment's log, and fails without.
    Ort::Env& env = environment();
    Ort::SessionOptions session_options;
    session_options.SetIntraOpNumThreads(options.threads);
    session_options.SetInterOpNumThreads(1);
    session_options.SetExecutionMode(ORT_SEQUENTIAL);
    session_options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
    // A plan of the memory takes a block of its own beside what the arena has: 4 MB more, no
    // faster.
    session_options.DisableMemPattern();
    // Idle threads must not spin: tracking and mapping share the cores.
    session_options.AddConfigEntry("session.intra_op.allow_spinning", "0");
    session_options.AddConfigEntry("session.inter_op.allow_spinning", "0");
    add_provider(provider_, session_options);
    session_ = Ort::Session(env, bytes.data(), bytes.size(), session_options);
  }

  void run_session() {
    const char* input_name = input_name_.c_str();
    const char* output_name = output_name_.c_str();
    session_.Run(Ort::RunOptions{nullptr}, &input_name, &input_tensor_, 1, &output_name,
                 &output_tensor_, 1);
  }

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
    std::vector<std::int64_t> input_shape = shape(session_.GetInputTypeInfo(0));
    std::vector<std::int64_t> image_shape = input_shape;
    if (layout_ == yolox::InputLayout::phases) {
      image_shape = {1, 3, 2 * input_shape.at(2), 2 * input_shape.at(3)};
    }
    size_ = yolox::check_shapes(model, image_shape, shape(session_.GetOutputTypeInfo(0)));
    input_shape[0] = 1;
    Ort::AllocatorWithDefaultOptions allocator;
    input_name_ = session_.GetInputNameAllocated(0, allocator).get();
    output_name_ = session_.GetOutputNameAllocated(0, allocator).get();
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
  yolox::InputLayout layout_ = yolox::InputLayout::planes;
  std::vector<float> input_, output_;
  Ort::Value input_tensor_{nullptr}, output_tensor_{nullptr};
};

}  // namespace

std::unique_ptr<YoloxNetwork> load_yolox_onnxruntime(const YoloxOptions& options,
                                                     const std::string& model) {
  return std::make_unique<OnnxNetwork>(options, model);
}

}  // namespace dkp_slam
