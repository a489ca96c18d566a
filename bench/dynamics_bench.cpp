// Measures the dynamics room alone on TUM folders: masks and features against mask/ where the
// folder has one, and the time of each stage.

#include <algorithm>
#include <filesystem>
#include <fstream>

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
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/system/config.h"

namespace dkp_slam::bench {
namespace dynamics {
namespace {

struct BenchOptions {
  std::string sequence, camera, model, detections, csv, features, overlay, mode = "dkp+",
                                                                           clustering;
  int first = 0, last = 1 << 30, overlay_every = 0;
  std::vector<int> overlay_frames;
  std::vector<std::string> settings;
};

struct Entry {
  double timestamp = 0.0;
  std::string colour, depth;
};

std::vector<Entry> read_associations(const std::filesystem::path& folder) {
  std::ifstream in(folder / "associations.txt");
  if (!in) throw Error("dynamics_bench: no associations.txt in " + folder.string());
  std::vector<Entry> entries;
  Entry e;
  double depth_time = 0.0;
  while (in >> e.timestamp >> e.colour >> depth_time >> e.depth) entries.push_back(e);
  return entries;
}

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

struct Totals {
  MaskScoreTally tally;
  std::size_t frames = 0, features = 0, kept = 0;
  std::vector<double> clustering_ms, removal_ms;
};

void run(const BenchOptions& bench) {
  const Camera camera = load_camera(bench.camera);
  DynamicsOptions options;
  options.mode = mode_named(bench.mode);
  if (bench.clustering == "paper") options.clustering.mode = ClusteringMode::paper;
  if (bench.clustering == "band") options.clustering.mode = ClusteringMode::band;
  SlamConfig config;
  config.dynamics = options;
  OptionList list = OptionList::of(config);
  for (const std::string& setting : bench.settings) list.assign(setting);
  options = config.dynamics;
  DynamicsModule dynamics(camera, options);
  OrbExtractor orb;
  std::unique_ptr<Detector> detector;
  if (!bench.model.empty()) {
    YoloxOptions yolox;
    yolox.model = bench.model;
    detector = make_yolox_detector(yolox);
  } else if (!bench.detections.empty()) {
    detector = open_recorded_detections(bench.detections, ClassTable());
  }
  const std::filesystem::path folder(bench.sequence);
  const std::vector<Entry> entries = read_associations(folder);
  if (!bench.overlay.empty()) std::filesystem::create_directories(bench.overlay);
  std::ofstream csv(bench.csv);
  if (csv) csv << "frame,iou,inside,inside_removed,outside,outside_kept,clustering_ms,removal_ms\n";
  std::ofstream features(bench.features);
  if (features) features << "frame,x,y,level,truth,static,masked,region,residual,depth\n";
  Totals totals;
  const int end = std::min(static_cast<int>(entries.size()), bench.last);
  ImageReader images;
  for (int i = bench.first; i < end; ++i) {
    const Entry& e = entries[static_cast<std::size_t>(i)];
    RgbdFrame frame;
    frame.index = i;
    frame.timestamp = e.timestamp;
    frame.colour = images.read_colour((folder / e.colour).string()).image;
    const cv::Mat raw = images.read_unchanged((folder / e.depth).string()).image;
    raw.convertTo(frame.depth, CV_32F, 1.0 / camera.depth_scale);
    frame.depth.setTo(0.0F, frame.depth < camera.min_depth);
    frame.depth.setTo(0.0F, frame.depth > camera.max_depth);
    const auto mask_path = folder / "mask" / std::filesystem::path(e.colour).filename();
    const cv::Mat truth = std::filesystem::exists(mask_path)
                              ? images.read_grey_png(mask_path.string()).image
                              : cv::Mat();
    if (options.mode == DynamicsMode::masks) frame.mask = truth;
    cv::Mat grey;
    cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
    const auto keypoints = orb.extract(grey).keypoints;
    DetectionResult answer;
    answer.timestamp = frame.timestamp;
    answer.answered = detector && detector->looks_at(frame);
    if (answer.answered) answer.detections = detector->detect(frame);
    const FrameDynamics result = dynamics.process(frame, grey, keypoints, answer);
    ++totals.frames;
    totals.features += keypoints.size();
    totals.clustering_ms.push_back(result.clustering_ms);
    totals.removal_ms.push_back(result.removal_ms);
    std::vector<cv::Point2f> points;
    std::vector<bool> kept;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      points.push_back(keypoints[k].pt);
      kept.push_back(result.features[k].is_static);
      totals.kept += kept.back() ? 1 : 0;
    }
    FeatureCounts counts;
    double iou = -1.0;
    if (!truth.empty()) {
      const auto scores = score_mask(truth, result.mask);
      counts = count_features(truth, points, kept);
      totals.tally.add(scores, counts);
      if (!scores.empty()) {
        iou = 0.0;
        for (const auto& s : scores) iou += s.iou / static_cast<double>(scores.size());
      }
    }
    if (features) write_features(features, frame, keypoints, result, truth);
    if (csv) {
      csv << fmt::format("{},{:.3f},{},{},{},{},{:.2f},{:.2f}\n", i, iou, counts.inside,
                         counts.inside_removed, counts.outside, counts.outside_kept,
                         result.clustering_ms, result.removal_ms);
    }
    const bool listed = std::find(bench.overlay_frames.begin(), bench.overlay_frames.end(), i) !=
                        bench.overlay_frames.end();
    const bool due = bench.overlay_every > 0 && i % bench.overlay_every == 0;
    if (!bench.overlay.empty() && (listed || due)) {
      write_image(fmt::format("{}/{:04d}.png", bench.overlay, i),
                  picture_of(frame, keypoints, result, truth));
    }
  }
  const auto percent = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.2f}", 100.0 * *v) : std::string("-");
  };
  fmt::print(
      "{} mode {}: {} frames, mean IoU {} % over {}, removed {} %, kept {} %, features {} kept "
      "{}, clustering {:.2f} ms, removal {:.2f} ms\n",
      folder.filename().string(), bench.mode, totals.frames, percent(totals.tally.mean_iou()),
      totals.tally.frames(), percent(totals.tally.removed_share()),
      percent(totals.tally.kept_share()), totals.features, totals.kept,
      median(totals.clustering_ms), median(totals.removal_ms));
}

}  // namespace
}  // namespace dynamics

void add_dynamics(CLI::App& program) {
  CLI::App* app = program.add_subcommand("dynamics", "Measures the dynamics room on a TUM folder");
  const auto bench = std::make_shared<dynamics::BenchOptions>();
  app->add_option("sequence", bench->sequence, "TUM folder with associations.txt")->required();
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
