#include "dkp_slam/detection/factory/detector_factory.h"

#include <array>
#include <cstdlib>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "dkp_slam/detection/yolox/yolox_decode.h"
#include "dkp_slam/detection/yolox/yolox_model.h"
#include "dkp_slam/detection/yolox/yolox_network.h"
#include "dkp_slam/error.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

class YoloxDetector : public Detector {
 public:
  YoloxDetector(std::unique_ptr<YoloxNetwork> network, YoloxOptions options)
      : network_(std::move(network)), options_(std::move(options)), schedule_(options_.looks) {
    network_->run();
  }

  std::string name() const override { return "yolox (" + network_->name() + ")"; }

  bool looks_at(const RgbdFrame& frame) override {
    return schedule_.due(frame.timestamp, frame.depth);
  }

  std::vector<Detection> detect(const RgbdFrame& frame) override {
    if (frame.colour.empty() || frame.colour.type() != CV_8UC3) {
      throw Error("YOLOX needs a colour image of 3 channels with 8 bits each");
    }
    const cv::Size size = network_->input_size();
    const float factor =
        yolox::letterbox(frame.colour, size, network_->layout(), network_->input(), scratch_);
    std::vector<Detection> found = yolox::decode(network_->run(), size, factor, frame.colour.size(),
                                                 options_.classes, options_.decode);
    schedule_.saw(found, frame.colour.size());
    return found;
  }

 private:
  std::unique_ptr<YoloxNetwork> network_;
  YoloxOptions options_;
  LookSchedule schedule_;
  cv::Mat scratch_;
};

using LoadNetwork = std::unique_ptr<YoloxNetwork> (*)(const YoloxOptions&, const std::string&);

/// The library that is to run the network.
LoadNetwork choose_library(const YoloxOptions& options) {
#ifdef DKP_SLAM_HAVE_ONNXRUNTIME
  if (options.backend != YoloxBackend::opencv) return load_yolox_onnxruntime;
#else
  if (options.backend == YoloxBackend::onnxruntime) {
    throw Error(
        "this build has no ONNX Runtime; run scripts/setup.sh and build again, or use "
        "OpenCV");
  }
#endif
  if (options.provider != "cpu") {
    spdlog::warn("OpenCV's dnn runs on the cpu only, not on '{}'", options.provider);
  }
  return load_yolox_opencv;
}

/// A network that computes only what the images fill of its input, a quarter less for 4:3 in a
/// square; all of it where their size is not known (0 x 0) or the model can't be cut.
std::unique_ptr<YoloxNetwork> load_network(const YoloxOptions& options, const cv::Size& images) {
  const LoadNetwork load = choose_library(options);
  const std::string model = yolox::read_model(options.model);
  if (const std::string cut = yolox::cut_to_images(model, images); !cut.empty()) {
    try {
      return load(options, cut);
    } catch (const Error& error) {
      spdlog::debug("the model is used with its own size: {}", error.what());
    }
  }
  return load(options, model);
}

void check(const YoloxOptions& options) {
  const std::string model = options.model.string();
  if (!fs::is_regular_file(options.model)) {
    throw Error("no model file '" + model + "'; " + model_advice());
  }
  options.check();
}

std::optional<fs::path> model_in(const fs::path& folder) {
  for (const char* size : {"nano", "tiny", "s", "m", "l", "x"}) {
    const fs::path file = folder / (std::string("yolox_") + size + ".onnx");
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return file;
  }
  return std::nullopt;
}

}  // namespace

std::unique_ptr<Detector> make_yolox_detector(const YoloxOptions& options, const cv::Size& images) {
  check(options);
  return std::make_unique<YoloxDetector>(load_network(options, images), options);
}

std::unique_ptr<Detector> make_detector(const DetectorOptions& options, const Camera& camera) {
  if (options.kind == DetectorKind::none) return nullptr;
  std::unique_ptr<Detector> detector;
  if (options.kind != DetectorKind::motion) {
    YoloxOptions yolox = options.yolox;
    const auto model = find_model(yolox.model);
    if (model) {
      yolox.model = *model;
      detector = make_yolox_detector(yolox, {camera.width, camera.height});
      spdlog::info("detector: {}, model {}", detector->name(), model->string());
      return detector;
    }
    if (options.kind == DetectorKind::yolox) {
      throw Error("no YOLOX model found; " + model_advice());
    }
    spdlog::info("no YOLOX model found, so the motion detector finds what moves by itself; {}",
                 model_advice());
  }
  detector = std::make_unique<MotionDetector>(camera, options.motion);
  spdlog::info("detector: {}", detector->name());
  return detector;
}

std::optional<fs::path> find_model(const fs::path& wanted) {
  const char* variable = std::getenv("DKP_SLAM_MODEL");
  if (!wanted.empty() || (variable != nullptr && *variable != '\0')) {
    const fs::path file = !wanted.empty() ? wanted : fs::path(variable);
    if (!fs::is_regular_file(file)) {
      throw Error("no model file '" + file.string() + "'" +
                  (wanted.empty() ? " (from DKP_SLAM_MODEL)" : "") + "; " + model_advice());
    }
    return file;
  }
  std::error_code no_link;
  const fs::path program = fs::read_symlink("/proc/self/exe", no_link);
  std::vector<fs::path> folders{fs::path("models")};
  if (!no_link) {
    const fs::path folder = program.parent_path();
    folders.push_back(folder / "models");
    folders.push_back(folder.parent_path() / "share/dkp-slam/models");
  }
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (cache != nullptr && *cache != '\0') {
    folders.push_back(fs::path(cache) / "dkp-slam");
  } else if (home != nullptr) {
    folders.push_back(fs::path(home) / ".cache" / "dkp-slam");
  }
  for (const fs::path& folder : folders) {
    if (auto file = model_in(folder)) return file;
  }
  return std::nullopt;
}

std::string model_advice() {
  return "scripts/fetch_model.sh (installed: dkp-slam-fetch-model) gets one from "
         "https://github.com/Megvii-BaseDetection/YOLOX/releases/tag/0.1.1rc0 "
         "(yolox_nano.onnx: sha256 "
         "c789161ed43c8269fcd4e67c67eeeb4e80c622da2eb296a20bc6007bd18a0b7d)";
}

}  // namespace dkp_slam
