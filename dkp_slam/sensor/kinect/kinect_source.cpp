#include "dkp_slam/sensor/kinect/kinect_source.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/kinect/kinect_clock.h"
#include "dkp_slam/sensor/kinect/kinect_device.h"
#include "dkp_slam/sensor/stamp_pairing.h"

namespace dkp_slam {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr double frame_rate = 30.0;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double unix_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class FreenectSource : public KinectSource {
 public:
  explicit FreenectSource(const KinectOptions& options)
      : options_(options), pairing_(options.max_difference) {
    if (!(options.max_difference > 0.0)) throw Error("max_difference must be above 0 s");
    opened_wall_ = unix_time();
    auto device = open();  // throws here, where somebody listens
    thread_ =
        std::thread([this, first = std::move(device)]() mutable { listen(std::move(first)); });
  }
  ~FreenectSource() override {
    ending_ = true;
    thread_.join();
    if (lost_ > 0) spdlog::warn("kinect: {} frames were lost", lost_.load());
  }
  FreenectSource(const FreenectSource&) = delete;
  FreenectSource& operator=(const FreenectSource&) = delete;

  std::string description() const override { return "kinect"; }
  std::optional<std::size_t> size() const override { return std::nullopt; }
  std::size_t skipped() const override { return 0; }
  std::size_t lost() const override { return lost_; }

  void use_camera(const Camera& camera) override {
    if (camera.width != KinectDevice::width || camera.height != KinectDevice::height) {
      throw Error(
          fmt::format("kinect: its images are {} x {} pixels but the camera file says {} x "
                      "{}; use the camera file of this camera",
                      KinectDevice::width, KinectDevice::height, camera.width, camera.height));
    }
    camera_ = camera;
    corrector_ = DepthCorrector(camera.depth_correction, {camera.width, camera.height});
  }

  std::optional<RgbdFrame> read() override {
    std::unique_lock lock(mutex_);
    // Also when it was stopped: what the Kinect had sent by then is not lost.
    arrived_.wait(lock, [this] { return !waiting_.empty() || heard_all_; });
    if (waiting_.empty()) {
      if (failure_.empty()) return std::nullopt;
      throw Error(failure_);
    }
    const Pair pair = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    return frame_of(pair);
  }

 private:
  using Pair = StampPairing<cv::Mat>::Pair;

  bool stopped() const { return options_.stop && *options_.stop; }
  bool over() const { return ending_ || stopped(); }

  std::unique_ptr<KinectDevice> open() {
    clock_.restart(opened_wall_ + seconds_since(opened_));
    before_.reset();
    return std::make_unique<KinectDevice>(
        options_.number,
        [this](cv::Mat image, std::uint32_t ticks) { take(std::move(image), ticks, true); },
        [this](cv::Mat image, std::uint32_t ticks) { take(std::move(image), ticks, false); });
  }

  /// The thread that takes images, until the end or until no Kinect came back.
  void listen(std::unique_ptr<KinectDevice> device) {
    heard_ = Clock::now();
    while (!over()) {
      std::string problem = "kinect: was unplugged or broke off";
      try {
        if (!device) device = open();
        if (play(*device)) problem = fmt::format("kinect: no image for {:g} s", options_.silence);
      } catch (const Error& error) {
        problem = error.what();
      }
      device.reset();
      // Nothing that could be nearer will come any more.
      while (auto pair = pairing_.next(true)) hand_on(std::move(*pair));
      if (over()) break;
      if (!std::exchange(away_, true)) {
        spdlog::warn("{}; waiting {:g} s for it to come back", problem, options_.reconnect);
      }
      if (seconds_since(heard_) > options_.reconnect) {
        give_up(problem);
        break;
      }
      std::this_thread::sleep_for(milliseconds(200));
    }
    {
      const std::scoped_lock lock(mutex_);
      heard_all_ = true;
    }
    arrived_.notify_all();
  }

  /// False when the device is gone, true when it says nothing, or at the end.
  bool play(KinectDevice& device) const {
    const Clock::time_point start = Clock::now();
    while (!over()) {
      if (!device.process()) return false;
      if (std::min(seconds_since(heard_), seconds_since(start)) > options_.silence) return true;
    }
    return true;
  }

  void give_up(const std::string& problem) {
    const std::scoped_lock lock(mutex_);
    failure_ =
        fmt::format("{}; no image came for {:g} s (--reconnect)", problem, options_.reconnect);
  }

  void take(cv::Mat image, std::uint32_t ticks, bool colour) {
    heard_ = Clock::now();
    if (std::exchange(away_, false)) spdlog::info("kinect: is there again");
    const double stamp = clock_.seconds(ticks);
    if (colour) {
      pairing_.add_colour(stamp, std::move(image));
    } else {
      pairing_.add_depth(stamp, std::move(image));
    }
    while (auto pair = pairing_.next()) hand_on(std::move(*pair));
  }

  void hand_on(Pair pair) {
    if (before_) {
      const double steps = std::round((pair.colour_stamp - *before_) * frame_rate);
      if (steps > 1.0) note_lost(static_cast<std::size_t>(steps) - 1);
    }
    before_ = pair.colour_stamp;
    {
      constexpr std::size_t most_waiting = 30;  // a second, 46 MB
      const std::scoped_lock lock(mutex_);
      waiting_.push_back(std::move(pair));
      if (waiting_.size() > most_waiting) {
        waiting_.pop_front();
        note_lost(1);
      }
    }
    arrived_.notify_all();
  }

  void note_lost(std::size_t count) {
    if (lost_.fetch_add(count) == 0) {
      spdlog::warn("kinect: frames are lost, on USB or because they are not read in time; counted");
    }
  }

  RgbdFrame frame_of(const Pair& pair) {
    constexpr double millimetres = 1000.0;
    RgbdFrame frame;
    frame.index = index_++;
    frame.timestamp = pair.colour_stamp;
    frame.depth_delay = pair.depth_stamp - pair.colour_stamp + camera_.depth_correction.delay;
    cv::cvtColor(pair.colour, frame.colour, cv::COLOR_RGB2BGR);
    frame.depth = depth_in_metres(pair.depth, millimetres, camera_.min_depth, camera_.max_depth);
    corrector_.apply(frame.depth);
    return frame;
  }

  const KinectOptions options_;
  Camera camera_;
  DepthCorrector corrector_;
  const Clock::time_point opened_ = Clock::now();
  double opened_wall_ = 0.0;
  int index_ = 0;
  std::atomic<bool> ending_ = false;
  std::atomic<std::size_t> lost_ = 0;

  // Of the thread that takes images.
  Clock::time_point heard_ = Clock::now();
  bool away_ = false;
  KinectClock clock_;
  StampPairing<cv::Mat> pairing_;
  std::optional<double> before_;  // stamp of the pair before, of this device

  std::mutex mutex_;  // of the four below
  std::condition_variable arrived_;
  std::deque<Pair> waiting_;
  std::string failure_;
  bool heard_all_ = false;  // nothing more will wait

  std::thread thread_;  // last: it uses the others
};

}  // namespace

bool can_read_kinects() { return true; }

std::unique_ptr<KinectSource> open_kinect(const KinectOptions& options) {
  return std::make_unique<FreenectSource>(options);
}

}  // namespace dkp_slam
