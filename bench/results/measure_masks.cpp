#include <atomic>
#include <fstream>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/results/measure.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/mask_score.h"
#include "dkp_slam/evaluation/measure/fingerprint.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/json_text.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/playback.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam::bench {
namespace {

namespace fs = std::filesystem;

// The system runs in this program, so this program decides what comes out.
const char* const this_program = "/proc/self/exe";

fs::path record_of(const MeasureOptions& options, const RunKey& key) {
  return run_folder(options, key) / "masks.json";
}

std::unique_ptr<Detector> detector_of(const MeasureOptions& options, const Camera& camera) {
  DetectorOptions detector;
  detector.kind = options.model.empty() ? DetectorKind::motion : DetectorKind::yolox;
  detector.yolox.model = options.model;
  return make_detector(detector, camera);
}

/// Scores the masks and verdicts of frames that there are true masks for.
class MaskObserver : public SlamObserver {
 public:
  explicit MaskObserver(fs::path masks) : masks_(std::move(masks)) {}
  void on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) override {
    const fs::path path = masks_ / fmt::format("{:.6f}.png", snapshot->frame.timestamp);
    const cv::Mat truth = images_.read_grey_png(path.string()).image;
    if (truth.empty()) return;
    const FrameDynamics& dynamics = snapshot->dynamics;
    std::vector<cv::Point2f> positions;
    std::vector<bool> kept;
    for (std::size_t i = 0; i < snapshot->keypoints.size(); ++i) {
      positions.push_back(snapshot->keypoints[i].pt);
      // Mode off reports on no feature: it keeps them all.
      kept.push_back(dynamics.features.empty() || dynamics.features[i].is_static);
    }
    tally_.add(score_mask(truth, dynamics.mask), count_features(truth, positions, kept));
    ++compared_;
  }
  /// Once the run has finished.
  const MaskScoreTally& tally() const { return tally_; }
  std::size_t compared() const { return compared_; }

 private:
  const fs::path masks_;
  ImageReader images_;
  MaskScoreTally tally_;
  std::size_t compared_ = 0;
};

nlohmann::ordered_json json_of(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::optional<double> optional_of(const nlohmann::json& json, const char* name) {
  return json.at(name).is_null() ? std::nullopt : std::optional(json.at(name).get<double>());
}

}  // namespace

bool has_masks(const MeasureOptions& options, const std::string& sequence) {
  return fs::is_directory(options.data / sequence / "mask");
}

std::optional<MaskFigures> read_masks(const MeasureOptions& options, const RunKey& key) {
  std::ifstream in(record_of(options, key));
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  if (json.is_discarded() || json.value("program", std::string()) != fingerprint(this_program) ||
      json.value("model", std::string()) != options.model.string()) {
    return std::nullopt;
  }
  return MaskFigures{key, json.at("scored_frames"), optional_of(json, "iou"),
                     optional_of(json, "removed"), optional_of(json, "kept")};
}

std::optional<MaskFigures> measure_masks(const MeasureOptions& options, const RunKey& key,
                                         const std::function<bool()>& stop,
                                         const std::function<void(std::size_t)>& progress) {
  const fs::path sequence = options.data / key.sequence;
  SlamConfig slam_options;
  slam_options.camera = load_camera(camera_of(options, key.sequence).string());
  slam_options.dynamics.mode = mode_named(key.mode);
  slam_options.seed = key.seed;
  slam_options.final_adjustment = false;  // masks are there before it
  Slam slam(slam_options, detector_of(options, slam_options.camera));
  const auto masks = std::make_shared<MaskObserver>(sequence / "mask");
  slam.add_observer(masks, {Delivery::every});
  const auto source = open_tum_folder(sequence.string(), slam_options.camera);
  std::size_t frames = 0;
  std::atomic<bool> stopped{false};
  play(*source, slam, {.stop = &stopped}, [&](const FrameResult&) {
    progress(++frames);
    if (stop()) stopped = true;
  });
  if (stopped) return std::nullopt;
  if (masks->compared() == 0) {
    throw Error((sequence / "mask").string() +
                ": no mask is named like a colour image; is it of this sequence?");
  }
  const MaskScoreTally& tally = masks->tally();
  const MaskFigures figures{key, tally.frames(), tally.mean_iou(), tally.removed_share(),
                            tally.kept_share()};
  fs::create_directories(run_folder(options, key));
  const nlohmann::ordered_json record = {
      {"program", fingerprint(this_program)},   {"model", options.model.string()},
      {"scored_frames", figures.scored_frames}, {"iou", json_of(figures.iou)},
      {"removed", json_of(figures.removed)},    {"kept", json_of(figures.kept)}};
  write_file_atomically(record_of(options, key), json_text(record) + "\n");
  return figures;
}

}  // namespace dkp_slam::bench
