#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/camera_choice.h"
#include "apps/commands.h"
#include "apps/frame_rate_option.h"
#include "apps/progress.h"
#include "apps/source_choice.h"
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/stream/stream_writer.h"
#include "dkp_slam/system/pace.h"

namespace dkp_slam::apps {
namespace {

struct StreamArguments {
  SourceChoice source;
  std::string to = "-";
  bool realtime = false;
  std::optional<double> rate;
  double wait = 10.0;
};

/// Returns how many frames were sent.
std::size_t send(RgbdSource& source, StreamWriter& writer, std::optional<Pace> pace) {
  Progress progress("stream", source.size());
  std::size_t sent = 0;
  bool going = writer.begin();
  while (going) {
    const auto frame = source.read();
    if (!frame) {
      writer.end();
      break;
    }
    if (pace) pace->wait_for(frame->timestamp, &interrupt_flag());
    going = !interrupted() && writer.write(*frame);
    if (going) progress.update(++sent);
  }
  return sent;
}

void stream(const StreamArguments& arguments) {
  if (is_stream(arguments.source.name)) {
    throw CLI::ValidationError("SEQUENCE", "must be a folder of images, a bag or kinect");
  }
  if (arguments.rate && !arguments.realtime) throw CLI::ValidationError("--rate needs --realtime");
  catch_interrupts();
  const OpenedSource opened = open_source(arguments.source);
  ChannelOptions channel;
  channel.stop = &interrupt_flag();
  ByteOutput output(StreamAddress::parse(arguments.to), channel, arguments.wait);
  StreamWriter writer(output, opened.camera);
  std::optional<Pace> pace;
  if (arguments.realtime) pace.emplace(arguments.rate.value_or(1.0));
  const std::size_t sent = send(*opened.source, writer, pace);
  if (interrupted()) throw Error(fmt::format("interrupted after {} frames", sent));
}

}  // namespace

void add_stream_command(CLI::App& program) {
  const auto arguments = std::make_shared<StreamArguments>();
  CLI::App* command = program.add_subcommand(
      "stream",
      "Plays a folder as a camera's driver would: sends it as a frame stream "
      "(docs/frame-stream.md) "
      "to a pipe or to a program that listens, for instance dkp-slam run --source ADDRESS.");
  command
      ->add_option("SEQUENCE", arguments->source.name,
                   "Folder of images or bag (docs/sources.md), or kinect")
      ->required();
  command->add_option(
      "--camera", arguments->source.camera,
      fmt::format("Camera file, or {}, as for run; goes with the stream", camera_names));
  add_frame_rate_option(*command, arguments->source.frame_rate);
  command->add_option("--masks", arguments->source.masks, "Folder of masks to send, as for run");
  command
      ->add_option("--to", arguments->to,
                   "Where to: - (standard output), unix:PATH, tcp:PORT or tcp:HOST:PORT")
      ->capture_default_str();
  command
      ->add_option("--wait", arguments->wait, "Seconds to wait for somebody to listen at a socket")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_flag("--realtime", arguments->realtime,
                    "By the time stamps, as a camera; else as fast as it is taken");
  command
      ->add_option("--rate", arguments->rate, "With --realtime: so many times as fast; default: 1")
      ->check(CLI::Range(0.01, 100.0));
  command->callback([arguments] { stream(*arguments); });
}

}  // namespace dkp_slam::apps
