#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/commands.h"
#include "apps/process.h"
#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

struct DetectOptions {
  std::vector<fs::path> images;
  fs::path model, classes, out;
  YoloxOptions yolox;
};

/// Red for what moves by itself, amber for what is carried or pushed, in OpenCV's BGR.
cv::Scalar colour_of(const Detection& detection) {
  return detection.weight >= 10.0F ? cv::Scalar(60, 60, 235) : cv::Scalar(30, 170, 240);
}

void draw(cv::Mat& image, const Detection& detection) {
  const double scale = std::max(0.4, image.rows / 1000.0);
  const int line = std::max(1, image.rows / 240);
  const cv::Rect box(detection.box.tl(), detection.box.br());
  const cv::Scalar colour = colour_of(detection);
  cv::rectangle(image, box, colour, line, cv::LINE_AA);

  const std::string text = cv::format("%s %.2f W%g", ClassTable::name(detection.class_id).data(),
                                      detection.score, detection.weight);
  int below = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &below);
  const int height = size.height + below + 4;
  // Above the box, or inside its top where the image ends; never past the right border.
  const cv::Rect label(std::clamp(box.x, 0, std::max(0, image.cols - size.width - 6)),
                       box.y >= height ? box.y - height : box.y, size.width + 6, height);
  cv::rectangle(image, label, colour, cv::FILLED);
  cv::putText(image, text, {label.x + 3, label.y + size.height + 2}, cv::FONT_HERSHEY_SIMPLEX,
              scale, cv::Scalar::all(255), 1, cv::LINE_AA);
}

/// A file of its own for each input, also where two of them share a name.
fs::path output_file(const fs::path& folder, const fs::path& image, std::set<fs::path>& taken) {
  fs::path file = folder / (image.stem().string() + ".png");
  for (int n = 2; !taken.insert(file).second; ++n) {
    file = folder / (image.stem().string() + "_" + std::to_string(n) + ".png");
  }
  return file;
}

void prepare_output(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  const fs::path probe = folder / ".dkp-slam-probe";
  const bool writable = !failure && std::ofstream(probe).put(' ').good();
  fs::remove(probe, failure);
  if (!writable) {
    throw Error("cannot write to the output folder '" + folder.string() + "'; choose another one");
  }
}

/// Detects, prints and draws one image. Returns the milliseconds of the detection.
double detect_one(Detector& detector, const fs::path& path, const cv::Mat& image,
                  const fs::path& out) {
  RgbdFrame frame;
  frame.colour = image;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Detection> found = detector.detect(frame);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  std::printf("%s: %zu %s, %.1f ms\n", one_line(path.string()).c_str(), found.size(),
              found.size() == 1 ? "object" : "objects", taken.count());
  for (const Detection& d : found) {
    std::printf("  %-14s score %.2f  weight %-4g x %.0f  y %.0f  width %.0f  height %.0f\n",
                ClassTable::name(d.class_id).data(), d.score, d.weight, d.box.x, d.box.y,
                d.box.width, d.box.height);
  }
  if (!out.empty()) {
    cv::Mat annotated = image.clone();
    // Strongest last, on top.
    std::for_each(found.rbegin(), found.rend(), [&](const Detection& d) { draw(annotated, d); });
    const std::vector<std::uint8_t> png = encode_png(annotated);
    write_file_atomically(out, {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  return taken.count();
}

void detect(DetectOptions options) {
  const auto model = find_model(options.model);
  if (!model) throw Error("no YOLOX model found; " + model_advice() + ", --model names it");
  options.yolox.model = *model;
  if (!options.classes.empty()) options.yolox.classes = ClassTable::load(options.classes);
  if (!options.out.empty()) prepare_output(options.out);
  const std::unique_ptr<Detector> detector = make_yolox_detector(options.yolox);
  std::printf("%s, model %s\n", detector->name().c_str(), model->c_str());

  std::vector<double> times;
  std::set<fs::path> taken;
  std::size_t failed = 0;
  ImageReader reader;
  for (const fs::path& path : options.images) {
    const auto [image, problem] = reader.read_colour(path.string());
    if (image.empty()) {
      std::fprintf(stderr, "dkp-slam: cannot read '%s': %s\n", one_line(path.string()).c_str(),
                   problem.c_str());
      ++failed;
      continue;
    }
    const fs::path out = options.out.empty() ? fs::path() : output_file(options.out, path, taken);
    if (times.empty()) {  // the first run is slower and tells nothing
      RgbdFrame frame;
      frame.colour = image;
      detector->detect(frame);
    }
    times.push_back(detect_one(*detector, path, image, out));
  }
  if (!times.empty()) {
    std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
    std::printf("%zu images, median %.1f ms\n", times.size(), times[times.size() / 2]);
  }
  if (failed > 0) {
    throw Error(std::to_string(failed) + " of " + std::to_string(options.images.size()) +
                " images could not be read");
  }
}

}  // namespace

void add_detect_command(CLI::App& program) {
  auto options = std::make_shared<DetectOptions>();
  CLI::App* command = program.add_subcommand(
      "detect", "Find movable objects in single images with YOLOX; print boxes and times.");
  command->add_option("images", options->images, "Image files (PNG, JPEG)")->required();
  command->add_option("--model", options->model,
                      "YOLOX model (.onnx); else DKP_SLAM_MODEL, models/, ~/.cache/dkp-slam");
  command->add_option("--out", options->out, "Folder for the images with boxes drawn (PNG)");
  options->yolox.decode.lowest_score = 0.3F;  // what a run starts an object on
  command->add_option("--score", options->yolox.decode.lowest_score, "Lowest score of a box")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--classes", options->classes,
                      "Class weights (YAML, see config/classes.yaml)");
  command->add_option("--provider", options->yolox.provider, "Execution provider of ONNX Runtime")
      ->check(CLI::IsMember({"cpu", "cuda", "tensorrt"}))
      ->capture_default_str();
  command->add_option("--threads", options->yolox.threads, "Threads of the network")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  const std::map<std::string, YoloxBackend> backends{{"auto", YoloxBackend::automatic},
                                                     {"onnxruntime", YoloxBackend::onnxruntime},
                                                     {"opencv", YoloxBackend::opencv}};
  command
      ->add_option("--backend", options->yolox.backend,
                   "Library that runs the network: auto, onnxruntime or opencv")
      ->transform(CLI::CheckedTransformer(backends, CLI::ignore_case));
  command->callback([options] { detect(*options); });
}

}  // namespace dkp_slam::apps
