#include "dkp_slam/sensor/stream/stream_source.h"

#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/camera_config.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/stream/stream_format.h"

namespace dkp_slam {
namespace {

constexpr int most_backward_frames = 30;  // in a row: a second of a usual camera

std::span<char> bytes_of(cv::Mat& image) {
  return {reinterpret_cast<char*>(image.data), image.total() * image.elemSize()};
}

class ByteSource : public StreamSource {
 public:
  ByteSource(const StreamAddress& address, const StreamOptions& options)
      : options_(options), input_(ByteInput::open(address, options.channel)) {
    constexpr double for_ever = -1.0;
    if (!input_->next_peer(for_ever) || !begin()) {
      throw Error(input_->name() + ": interrupted before a stream came");
    }
  }

  std::string description() const override { return input_->name(); }
  std::optional<std::size_t> size() const override { return std::nullopt; }
  std::size_t skipped() const override { return skipped_; }
  std::size_t without_mask() const override { return without_mask_; }
  const std::optional<Camera>& own_camera() const override { return own_camera_; }

  void use_camera(const Camera& camera) override {
    if (static_cast<int>(header_.width) != camera.width ||
        static_cast<int>(header_.height) != camera.height) {
      throw Error(
          fmt::format("{}: its images are {} x {} pixels but the camera file says {} x {}; "
                      "use the camera file of this camera",
                      input_->name(), header_.width, header_.height, camera.width, camera.height));
    }
    camera_ = camera;
  }

  std::optional<RgbdFrame> read() override {
    while (!ended_ && !stopped()) {
      try {
        if (connected_ || begin()) return read_frame();
        break;
      } catch (const Error& error) {
        if (!input_->has_peers() || ended_) throw;
        connected_ = false;
        wait_for_next(error.what());
      }
    }
    return std::nullopt;
  }

 private:
  bool stopped() const { return options_.channel.stop && *options_.channel.stop; }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(input_->name() + ": " + what);
  }

  /// False when it was stopped. Throws where the stream is cut. `between`: two records.
  bool fill(std::span<char> to, const std::string& what, bool between = false) {
    const std::size_t got = input_->read(to);
    if (got == to.size()) return true;
    if (stopped()) return false;
    if (got == 0 && between) {
      fail(fmt::format("cut off after {} frames, without the end record \"DONE\"", index_ + 1));
    }
    fail(fmt::format("cut off in the middle of {} ({} of {} bytes came)", what, got, to.size()));
  }

  /// Reads a header; false when it was stopped.
  bool begin() {
    std::array<char, stream::header_bytes> bytes{};
    if (!fill(bytes, "the header")) return false;
    stream::Header header;
    try {
      header = stream::parse_header(bytes);
    } catch (const Error& error) {
      fail(error.what());
    }
    std::string camera(header.camera_bytes, '\0');
    if (!fill(camera, "the camera file")) return false;
    if (!begun_) {
      if (!camera.empty()) own_camera_ = parse_camera(camera, input_->name() + " camera file");
      camera_text_ = std::move(camera);
    } else if (header.width != header_.width || header.height != header_.height) {
      fail(fmt::format("its images are {} x {} pixels, those before were {} x {}", header.width,
                       header.height, header_.width, header_.height));
    } else if (!camera.empty() && camera != camera_text_) {
      fail("brings another camera file than the driver before; start a new run for it");
    }
    header_ = header;
    begun_ = connected_ = true;
    return true;
  }

  /// The driver is gone: waits for one. Throws where none comes.
  void wait_for_next(const std::string& reason) {
    spdlog::warn("{}; waiting {:.3g} s for a driver to come back", reason, options_.reconnect);
    if (input_->next_peer(options_.reconnect)) {
      spdlog::info("{}: a driver is there again", input_->name());
    } else if (!stopped()) {
      throw Error(fmt::format("{}; no driver came back within {:.3g} s (--reconnect)", reason,
                              options_.reconnect));
    }
  }

  /// Nothing at the end and when it was stopped.
  std::optional<RgbdFrame> read_frame() {
    for (;;) {
      std::array<char, stream::record_head_bytes> bytes{};
      if (!fill(bytes, "a record's head", true)) return std::nullopt;
      stream::RecordHead head;
      try {
        head = stream::parse_record_head(bytes, header_);
      } catch (const Error& error) {
        fail(fmt::format("after frame {}: {}", index_, error.what()));
      }
      if (head.kind == stream::RecordKind::end) {
        ended_ = true;
        return std::nullopt;
      }
      RgbdFrame frame;
      if (!read_images(head.bytes != header_.frame_bytes(false), frame)) return std::nullopt;
      frame.index = ++index_;
      if (in_order(frame)) return frame;
    }
  }

  /// False when it was stopped.
  bool read_images(bool with_mask, RgbdFrame& frame) {
    const std::string what = fmt::format("frame {}", index_ + 1);
    const cv::Size size(static_cast<int>(header_.width), static_cast<int>(header_.height));
    std::array<double, 2> stamps{};
    const bool grey = header_.colour == stream::ColourFormat::grey8;
    const bool units = header_.depth == stream::DepthFormat::u16;
    cv::Mat colour(size, grey ? CV_8UC1 : CV_8UC3), depth(size, units ? CV_16UC1 : CV_32FC1), mask;
    if (with_mask) mask.create(size, CV_8UC1);
    const std::span stamp_bytes(reinterpret_cast<char*>(stamps.data()), sizeof(stamps));
    if (!fill(stamp_bytes, what) || !fill(bytes_of(colour), what) || !fill(bytes_of(depth), what) ||
        (with_mask && !fill(bytes_of(mask), what))) {
      return false;
    }
    if (!std::isfinite(stamps[0]) || !std::isfinite(stamps[1])) {
      fail(what + ": its time stamp or depth delay is no number");
    }
    frame.timestamp = stamps[0];
    frame.depth_delay = stamps[1];
    if (grey) cv::cvtColor(colour, colour, cv::COLOR_GRAY2BGR);
    if (header_.colour == stream::ColourFormat::rgb8)
      cv::cvtColor(colour, colour, cv::COLOR_RGB2BGR);
    frame.colour = colour;
    if (units) {
      depth = depth_in_metres(depth, header_.depth_scale, camera_.min_depth, camera_.max_depth);
    } else {
      keep_depth_range(depth, camera_.min_depth, camera_.max_depth);
    }
    frame.depth = depth;
    take_mask(mask, frame);
    return true;
  }

  void take_mask(const cv::Mat& mask, RgbdFrame& frame) {
    if (options_.masks) {
      frame.mask = mask;
      // That none has one shows in the count, and need not be wrong.
      had_mask_ = had_mask_ || !mask.empty();
      if (mask.empty() && without_mask_++ == 0 && had_mask_) {
        spdlog::warn("{}: frame {} has no mask", input_->name(), index_ + 1);
      }
    } else if (!mask.empty() && !said_masks_) {
      said_masks_ = true;
      spdlog::info("{}: its masks are not used; --mode masks does", input_->name());
    }
  }

  /// False for a frame to be left out.
  bool in_order(const RgbdFrame& frame) {
    if (!last_stamp_ || frame.timestamp > *last_stamp_) {
      last_stamp_ = frame.timestamp;
      backward_ = 0;
      return true;
    }
    const std::string problem =
        fmt::format("frame {}: its time stamp {:.6f} is not after the last frame's {:.6f}",
                    frame.index, frame.timestamp, *last_stamp_);
    if (skipped_++ == 0) {
      spdlog::warn("{}: {}; skipped, as others will be, without a word", input_->name(), problem);
    }
    if (++backward_ < most_backward_frames) return false;
    // No other driver could put that right: the clock must go on.
    ended_ = true;
    fail(
        fmt::format("{}, nor are those of {} before; a driver that comes back must go on by the "
                    "same clock",
                    problem, most_backward_frames - 1));
  }

  const StreamOptions options_;
  const std::unique_ptr<ByteInput> input_;
  stream::Header header_;
  Camera camera_;
  std::optional<Camera> own_camera_;
  std::string camera_text_;
  bool begun_ = false, connected_ = false, ended_ = false, said_masks_ = false, had_mask_ = false;
  int index_ = -1;  ///< of the last frame that came
  std::size_t skipped_ = 0, without_mask_ = 0;
  std::optional<double> last_stamp_;
  int backward_ = 0;
};

}  // namespace

std::unique_ptr<StreamSource> open_stream(const StreamAddress& address,
                                          const StreamOptions& options) {
  return std::make_unique<ByteSource>(address, options);
}

}  // namespace dkp_slam
