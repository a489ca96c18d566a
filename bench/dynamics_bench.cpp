// Measures the dynamics room alone on TUM folders: masks and features against mask/ where the
// folder has one, and the time of each stage.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/benches.h"
#include "dkp_slam/config/option_list.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/detection/recorded_detector.h"
#include "dkp_slam/dynamics/dynamics_module.h"
#include "dkp_slam/error.h"
#include "dkp_slam/evaluation/mask_score.h"
#include "dkp_slam/evaluation/overlay.h"
#include "dkp_slam/export/images/image_file.h"
#include "dkp_slam/feature/orb_extractor.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/tum_source.h"
#include "dkp_slam/system/config.h"

namespace dkp_slam::bench {
namespace dynamics {
namespace {

struct BenchOptions {
  std::string sequence, camera, model, detections, csv, features, overlay, mode = "dkp+",
                                                                           clustering;
  std::size_t first = 0;
  std::optional<std::size_t> last;
  int overlay_every = 0;
  std::vector<int> overlay_frames;
  std::vector<std::string> settings;
};

double median(std::vector<double> v) {
  if (v.empty()) return 0.0;
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Overlay and depth side by side, both with the outlines of the truth (white) and the mask (red).
cv::Mat picture_of(const RgbdFrame& frame, const std::vector<cv::KeyPoint>& keypoints,
                   const FrameDynamics& result, const cv::Mat& truth) {
  cv::Mat overlay = draw_overlay(frame, keypoints, result), scaled, depth, picture;
  frame.depth.convertTo(scaled, CV_8U, 255.0 / 4.0);
  cv::applyColorMap(scaled, depth, cv::COLORMAP_JET);
  depth.setTo(cv::Scalar(), frame.depth <= 0.0F);
  const auto outline = [](const cv::Mat& mask, const cv::Scalar& colour, cv::Mat& canvas) {
    if (mask.empty()) return;
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(mask.clone(), contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    cv::drawContours(canvas, contours, -1, colour, 2);
  };
  for (cv::Mat* canvas : {&overlay, &depth}) outline(truth, {255, 255, 255}, *canvas);
  outline(result.mask, {60, 60, 255}, depth);
  cv::hconcat(overlay, depth, picture);
  return picture;
}

/// One line per feature of the frame.
void write_features(std::ostream& out, const RgbdFrame& frame,
                    const std::vector<cv::KeyPoint>& keypoints, const FrameDynamics& result,
                    const cv::Mat& truth) {
  const cv::Rect image(cv::Point(), frame.depth.size());
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    const cv::Point pixel(cvRound(keypoints[k].pt.x), cvRound(keypoints[k].pt.y));
    if (!image.contains(pixel)) continue;
    const FeatureDynamics& f = result.features[k];
    const bool masked = !result.mask.empty() && result.mask.at<std::uint8_t>(pixel) != 0;
    out << fmt::format("{},{},{},{},{},{},{},{},{:.2f},{:.3f}\n", frame.index, pixel.x, pixel.y,
                       keypoints[k].octave, truth.empty() ? 0 : int{truth.at<std::uint8_t>(pixel)},
                       int{f.is_static}, int{masked}, static_cast<int>(f.region), f.motion_residual,
                       frame.depth.at<float>(pixel));
  }
}

DynamicsOptions options_of(const BenchOptions& bench) {
  SlamConfig config;
  config.dynamics.mode = mode_named(bench.mode);
  if (bench.clustering == "paper") config.dynamics.clustering.mode = ClusteringMode::paper;
  if (bench.clustering == "band") config.dynamics.clustering.mode = ClusteringMode::band;
  OptionList list = OptionList::of(config);
  for (const std::string& setting : bench.settings) list.assign(setting);
  return config.dynamics;
}

/// Null where neither a model nor detections are given.
std::unique_ptr<Detector> detector_of(const BenchOptions& bench) {
  if (!bench.model.empty()) {
    YoloxOptions yolox;
    yolox.model = bench.model;
    return make_yolox_detector(yolox);
  }
  if (bench.detections.empty()) return nullptr;
  return open_recorded_detections(bench.detections, ClassTable());
}

/// A frame of the sequence, and where people are in it (empty where that is not known).
struct KnownFrame {
  RgbdFrame frame;
  cv::Mat truth;
};

KnownFrame known_frame(RgbdFrame frame, int index, bool masks_are_given) {
  KnownFrame known{std::move(frame), {}};
  known.frame.index = index;
  known.truth = known.frame.mask;
  if (!masks_are_given) known.frame.mask.release();
  return known;
}

/// What a frame adds to the figures.
struct FrameScore {
  double iou = -1.0;  ///< mean of the frame's people; -1 where there is none to compare with
  FeatureCounts counts;
};

/// The figures of all frames so far, and the files with those of each.
class Tally {
 public:
  explicit Tally(const BenchOptions& bench) : csv_(bench.csv), features_(bench.features) {
    if (csv_) {
      csv_ << "frame,iou,inside,inside_removed,outside,outside_kept,clustering_ms,removal_ms\n";
    }
    if (features_) features_ << "frame,x,y,level,truth,static,masked,region,residual,depth\n";
  }

  void add(const KnownFrame& known, const std::vector<cv::KeyPoint>& keypoints,
           const FrameDynamics& result) {
    ++frames_;
    clustering_ms_.push_back(result.clustering_ms);
    removal_ms_.push_back(result.removal_ms);
    const FrameScore score = score_of(known.truth, keypoints, result);
    if (features_) write_features(features_, known.frame, keypoints, result, known.truth);
    if (csv_) {
      csv_ << fmt::format("{},{:.3f},{},{},{},{},{:.2f},{:.2f}\n", known.frame.index, score.iou,
                          score.counts.inside, score.counts.inside_removed, score.counts.outside,
                          score.counts.outside_kept, result.clustering_ms, result.removal_ms);
    }
  }

  void print(const std::string& sequence, const std::string& mode) const {
    const auto percent = [](const std::optional<double>& v) {
      return v ? fmt::format("{:.2f}", 100.0 * *v) : std::string("-");
    };
    fmt::print(
        "{} mode {}: {} frames, mean IoU {} % over {}, removed {} %, kept {} %, features {} kept "
        "{}, clustering {:.2f} ms, removal {:.2f} ms\n",
        sequence, mode, frames_, percent(masks_.mean_iou()), masks_.frames(),
        percent(masks_.removed_share()), percent(masks_.kept_share()), feature_count_, kept_,
        median(clustering_ms_), median(removal_ms_));
  }

 private:
  FrameScore score_of(const cv::Mat& truth, const std::vector<cv::KeyPoint>& keypoints,
                      const FrameDynamics& result) {
    std::vector<cv::Point2f> points;
    std::vector<bool> kept;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      points.push_back(keypoints[k].pt);
      kept.push_back(result.features[k].is_static);
      kept_ += kept.back() ? 1 : 0;
    }
    feature_count_ += keypoints.size();
    FrameScore score;
    if (truth.empty()) return score;
    const auto scores = score_mask(truth, result.mask);
    score.counts = count_features(truth, points, kept);
    masks_.add(scores, score.counts);
    if (!scores.empty()) {
      score.iou = 0.0;
      for (const auto& s : scores) score.iou += s.iou / static_cast<double>(scores.size());
    }
    return score;
  }

  std::ofstream csv_, features_;
  MaskScoreTally masks_;
  std::size_t frames_ = 0, feature_count_ = 0, kept_ = 0;
  std::vector<double> clustering_ms_, removal_ms_;
};

bool wants_picture(const BenchOptions& bench, int frame) {
  if (bench.overlay.empty()) return false;
  const auto& listed = bench.overlay_frames;
  return std::find(listed.begin(), listed.end(), frame) != listed.end() ||
         (bench.overlay_every > 0 && frame % bench.overlay_every == 0);
}

void run(const BenchOptions& bench) {
  const Camera camera = load_camera(bench.camera);
  const DynamicsOptions options = options_of(bench);
  DynamicsModule dynamics(camera, options);
  OrbExtractor orb;
  const std::unique_ptr<Detector> detector = detector_of(bench);
  TumOptions reading;
  reading.first_frame = bench.first;
  if (bench.last) reading.frame_limit = *bench.last - std::min(*bench.last, bench.first);
  const std::filesystem::path folder(bench.sequence);
  if (std::filesystem::exists(folder / "mask")) reading.masks = folder / "mask";
  const auto source = open_tum_folder(bench.sequence, camera, reading);
  if (!bench.overlay.empty()) std::filesystem::create_directories(bench.overlay);
  Tally tally(bench);
  while (auto frame = source->read()) {
    const int i = frame->index + static_cast<int>(bench.first);
    const KnownFrame known = known_frame(std::move(*frame), i, options.mode == DynamicsMode::masks);
    cv::Mat grey;
    cv::cvtColor(known.frame.colour, grey, cv::COLOR_BGR2GRAY);
    const auto keypoints = orb.extract(grey).keypoints;
    DetectionResult answer;
    answer.timestamp = known.frame.timestamp;
    answer.answered = detector && detector->looks_at(known.frame);
    if (answer.answered) answer.detections = detector->detect(known.frame);
    const FrameDynamics result = dynamics.process(known.frame, grey, keypoints, answer);
    tally.add(known, keypoints, result);
    if (wants_picture(bench, i)) {
      write_image(fmt::format("{}/{:04d}.png", bench.overlay, i),
                  picture_of(known.frame, keypoints, result, known.truth));
    }
  }
  tally.print(folder.filename().string(), bench.mode);
}

}  // namespace
}  // namespace dynamics

void add_dynamics(CLI::App& program) {
  CLI::App* app = program.add_subcommand("dynamics", "Measures the dynamics room on a TUM folder");
  const auto bench = std::make_shared<dynamics::BenchOptions>();
  app->add_option("sequence", bench->sequence, "TUM folder")->required();
  app->add_option("--camera", bench->camera, "camera file")->required();
  app->add_option("--model", bench->model, "YOLOX model");
  app->add_option("--set", bench->settings, "NAME=VALUE of the configuration");
  app->add_option("--detections", bench->detections, "file of detections instead of a model");
  app->add_option("--mode", bench->mode, mode_names());
  app->add_option("--clustering", bench->clustering)
      ->check(CLI::IsMember({"adaptive", "paper", "band"}));
  app->add_option("--first", bench->first, "first frame");
  app->add_option("--last", bench->last, "frame to stop before");
  app->add_option("--csv", bench->csv, "figures of every frame");
  app->add_option("--features", bench->features, "every feature of every frame");
  app->add_option("--overlay", bench->overlay, "folder for pictures");
  app->add_option("--overlay-every", bench->overlay_every, "a picture every so many frames");
  app->add_option("--overlay-frames", bench->overlay_frames, "pictures of these frames")
      ->delimiter(',');
  app->callback([bench] { dynamics::run(*bench); });
}

}  // namespace dkp_slam::bench
