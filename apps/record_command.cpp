#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "apps/frame_folder.h"
#include "apps/frame_rate_option.h"
#include "apps/progress.h"
#include "apps/source_choice.h"
#include "apps/true_path.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"
#include "dkp_slam/system/pace.h"

namespace dkp_slam::apps {
namespace {

struct RecordArguments {
  SourceChoice source;
  std::filesystem::path out;
  std::optional<std::size_t> frames;
  bool realtime = false;
};

struct Recorded {
  std::size_t written = 0, dropped = 0, skipped = 0;
  double first = 0.0, last = 0.0;  ///< seconds, stamps of the frames that were taken
  double longest_gap = 0.0;        ///< seconds between two frames that came
  std::string failure;             ///< what ended it early
};

/// groundtruth.txt, of the frames that were taken, where the source brings a true path.
void write_truth(const RecordArguments& arguments, const Recorded& recorded) {
  try {
    Trajectory path = true_path(arguments.source.name, arguments.source.frame_rate);
    constexpr double before = 1.0;  // second, for those who interpolate
    std::erase_if(path, [&](const StampedPose& pose) {
      return pose.timestamp < recorded.first - before || pose.timestamp > recorded.last + before;
    });
    if (!path.empty()) write_trajectory(arguments.out / "groundtruth.txt", path);
  } catch (const Error& error) {
    spdlog::warn("recorded without the truth: {}", error.what());
  }
}

/// Notes when a frame was taken.
void note(double timestamp, bool taken, Recorded& recorded, std::optional<double>& before) {
  if (before) recorded.longest_gap = std::max(recorded.longest_gap, timestamp - *before);
  before = timestamp;
  if (!taken) {
    if (recorded.dropped++ == 0) spdlog::warn("the disk is too slow: frames are dropped");
    return;
  }
  if (recorded.written++ == 0) recorded.first = timestamp;
  recorded.last = timestamp;
}

Recorded copy(RgbdSource& source, FrameFolder& folder, const RecordArguments& arguments) {
  const bool live = is_live(arguments.source.name);
  const std::size_t most = arguments.frames.value_or(std::numeric_limits<std::size_t>::max());
  std::optional<Pace> pace;
  if (arguments.realtime && !live) pace.emplace(1.0);
  Progress progress("record", arguments.frames ? arguments.frames : source.size());
  Recorded recorded;
  std::optional<double> before;
  try {
    // At Ctrl-C what is live ends by itself, after what it had sent.
    while ((live || !interrupted()) && recorded.written < most) {
      const auto frame = source.read();
      if (!frame) break;
      if (pace) pace->wait_for(frame->timestamp, &interrupt_flag());
      note(frame->timestamp, folder.add(*frame, !live && !arguments.realtime), recorded, before);
      progress.update(recorded.written);
    }
    folder.finish();
  } catch (const std::exception& error) {
    recorded.failure = error.what();
    try {
      folder.finish();
    } catch (const std::exception&) {  // the first is the cause
    }
  }
  recorded.written = folder.written();
  recorded.skipped = source.skipped();
  return recorded;
}

std::string text_of(const Recorded& recorded, const std::filesystem::path& out) {
  std::string text = fmt::format("{} frames in {}", recorded.written, out.string());
  if (recorded.written > 1 && recorded.last > recorded.first) {
    const double seconds = recorded.last - recorded.first;
    text += fmt::format(", {:.1f} s at {:.1f} Hz, {:.0f} ms at most from one to the next", seconds,
                        static_cast<double>(recorded.written - 1) / seconds,
                        1000.0 * recorded.longest_gap);
  }
  text += fmt::format("; {} dropped", recorded.dropped);
  if (recorded.skipped > 0) text += fmt::format(", {} not readable", recorded.skipped);
  return text + "\n";
}

void record(RecordArguments arguments) {
  if (arguments.source.name.empty()) {
    throw CLI::ValidationError("SEQUENCE", "is required, or --source");
  }
  catch_interrupts();
  arguments.source.stream_masks = true;
  const OpenedSource opened = open_source(arguments.source);
  FrameFolder folder(arguments.out, opened.camera);
  const Recorded recorded = copy(*opened.source, folder, arguments);
  if (recorded.written > 0) write_truth(arguments, recorded);
  std::fputs(text_of(recorded, arguments.out).c_str(), stdout);
  std::fflush(stdout);
  if (!recorded.failure.empty()) {
    throw Error(fmt::format("{} ({} holds the {} frames before)", recorded.failure,
                            arguments.out.string(), recorded.written));
  }
  if (recorded.written == 0) throw Error("no frame came");
}

}  // namespace

void add_record_command(CLI::App& program) {
  const auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command =
      program.add_subcommand("record",
                             "Writes what a Kinect or a camera's driver sends "
                             "(docs/frame-stream.md), or any other source, "
                             "as a folder in TUM RGB-D format, "
                             "until it ends or Ctrl-C; the folder is whole at any time.");
  auto* sequence =
      command->add_option("SEQUENCE", arguments->source.name,
                          "- for a stream on the standard input, a ROS 1 bag, or a folder to copy "
                          "(docs/sources.md)");
  command
      ->add_option("--source", arguments->source.name,
                   "Instead of SEQUENCE: kinect, or a socket to listen at, unix:PATH, tcp:PORT or "
                   "tcp:HOST:PORT, as for run")
      ->excludes(sequence);
  command->add_option("--camera", arguments->source.camera,
                      fmt::format("Camera file, or {}; else the source's own", camera_names));
  add_frame_rate_option(*command, arguments->source.frame_rate);
  command->add_option("--topics", arguments->source.topics,
                      "Of a bag: COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO; default: found by type "
                      "and name");
  command
      ->add_option("--reconnect", arguments->source.reconnect,
                   "Seconds that a Kinect, or a driver, that was cut off is waited for")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "Ends after so many")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000'000}));
  command->add_flag("--realtime", arguments->realtime,
                    "Take a pipe or folder by its time stamps and drop what the disk is too slow "
                    "for, as from a socket");
  command->add_option("--out", arguments->out, "Folder to make")->required();
  command->callback([arguments] { record(*arguments); });
}

}  // namespace dkp_slam::apps
