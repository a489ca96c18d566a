#include "dkp_slam/sensor/bag/bag_source.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <spdlog/spdlog.h>
#include <opencv2/core.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/bag/bag_records.h"
#include "dkp_slam/sensor/bag/ros_messages.h"
#include "dkp_slam/sensor/depth_registration.h"
#include "dkp_slam/sensor/image_reader.h"
#include "dkp_slam/sensor/stamp_pairing.h"

namespace dkp_slam {
namespace {

constexpr int most_skipped_in_a_row = 30;  // a second of a usual camera

using ros1::ImageMessage;

Se3 pose_of(const ros1::Transform& message) {
  const auto& r = message.rotation;
  const auto& t = message.translation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized(), {t.x, t.y, t.z}};
}

/// The same pixels, so that depth needs no registration.
bool same_pixels(const Camera& a, const Camera& b) {
  constexpr double pixel = 0.01;
  return a.width == b.width && a.height == b.height && std::abs(a.fx - b.fx) < pixel &&
         std::abs(a.fy - b.fy) < pixel && std::abs(a.cx - b.cx) < pixel &&
         std::abs(a.cy - b.cy) < pixel;
}

class RosBagSource : public BagSource {
 public:
  RosBagSource(const std::string& file, const BagOptions& options)
      : file_(file), pairing_(options.max_difference) {
    if (!(options.max_difference > 0.0)) throw Error("max_difference must be above 0 s");
    guard([&] { open(options); });
  }

  std::string description() const override { return file_; }
  std::optional<std::size_t> size() const override { return std::nullopt; }
  std::size_t skipped() const override { return skipped_; }
  const std::optional<Camera>& own_camera() const override { return own_camera_; }

  void use_camera(const Camera& camera) override {
    const cv::Size colour = first_images_.colour.size(), depth = first_images_.depth.size();
    if (colour.width != camera.width || colour.height != camera.height) {
      fail(
          fmt::format("its images are {} x {} pixels but the camera file says {} x {}; use the "
                      "camera file of this camera",
                      colour.width, colour.height, camera.width, camera.height));
    }
    if (depth_from_device_ && colour_from_device_ && depth_camera_ &&
        !same_pixels(*depth_camera_, camera)) {
      if (depth.width != depth_camera_->width || depth.height != depth_camera_->height) {
        fail(fmt::format("{}: its images are {} x {} pixels but its camera_info says {} x {}",
                         topics_.depth, depth.width, depth.height, depth_camera_->width,
                         depth_camera_->height));
      }
      registration_.emplace(*depth_camera_, camera,
                            *colour_from_device_ * depth_from_device_->inverse());
    } else if (colour != depth) {
      fail(fmt::format(
          "depth is {} x {} pixels but colour is {} x {}; depth must be registered to colour: name "
          "the topic where it is (--topics COLOUR,DEPTH)",
          depth.width, depth.height, colour.width, colour.height));
    }
    camera_ = camera;
    corrector_ = DepthCorrector(camera.depth_correction, {camera.width, camera.height});
  }

  std::optional<RgbdFrame> read() override {
    std::optional<RgbdFrame> frame;
    guard([&] { frame = next_frame(); });
    return frame;
  }

 private:
  using Pair = StampPairing<ImageMessage>::Pair;
  struct Images {
    cv::Mat colour;  // CV_8UC3 BGR
    cv::Mat depth;   // CV_32FC1 metres, as it was taken
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}", file_, what));
  }

  /// What rosbag throws becomes one line that names the file.
  template <class Work>
  void guard(const Work& work) const {
    try {
      work();
    } catch (const Error&) {
      throw;
    } catch (const rosbag::BagUnindexedException&) {
      fail("has no index, its recording was cut off; `rosbag reindex` mends it");
    } catch (const std::exception& error) {
      fail(fmt::format("is cut off or damaged{} ({})",
                       index_ < 0 ? "" : fmt::format(" after frame {}", index_), error.what()));
    }
  }

  /// The message, null where it is of another type; as rosbag believes what it is told, only after
  /// a look at the chunk.
  template <class Message>
  boost::shared_ptr<Message> message_of(const rosbag::MessageInstance& instance) const {
    records_->check_until(instance.getTime().toNSec());
    return instance.instantiate<Message>();
  }

  void open(const BagOptions& options) {
    if (!std::filesystem::exists(file_)) fail("no such file; check the path");
    if (!is_bag(file_)) fail("is no ROS 1 bag (those of ROS 2 are not read)");
    records_ = std::make_unique<BagRecords>(file_);
    bag_.open(file_, rosbag::bagmode::Read);
    try {
      topics_ = choose_topics(topics_of_bag(), options.topics);
    } catch (const Error& error) {
      fail(error.what());
    }
    spdlog::info("{}: colour {}, depth {}", file_, topics_.colour, topics_.depth);
    own_camera_ = camera_in(topics_.colour_info, is_rectified(topics_.colour));
    depth_camera_ = camera_in(topics_.depth_info, false);
    if (const auto pose = first<ros1::Transform>(topics_.colour_pose)) {
      colour_from_device_ = pose_of(*pose);
    }
    if (const auto pose = first<ros1::Transform>(topics_.depth_pose)) {
      depth_from_device_ = pose_of(*pose);
    }
    if (const auto unit = first<ros1::Float32>(topics_.depth_unit)) {
      if (!(unit->data > 0.0F)) fail(topics_.depth_unit + ": must be above 0");
      units_per_metre_ = 1.0 / static_cast<double>(unit->data);
    }
    view_ = std::make_unique<rosbag::View>(
        bag_, rosbag::TopicQuery(std::vector<std::string>{topics_.colour, topics_.depth}));
    next_ = view_->begin();
    first_pair_ = next_pair();
    if (!first_pair_) {
      fail(fmt::format("none of {} colour images has a depth image within {} s",
                       pairing_.unpaired(), options.max_difference));
    }
    first_images_ = images_of(*first_pair_);
    note_rate();
  }

  std::vector<BagTopic> topics_of_bag() const {
    std::vector<BagTopic> topics;
    for (const rosbag::ConnectionInfo* connection : rosbag::View(bag_).getConnections()) {
      const bool known = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
        return topic.name == connection->topic;
      });
      if (known) continue;
      rosbag::View messages(bag_, rosbag::TopicQuery(connection->topic));
      topics.push_back({connection->topic, connection->datatype, messages.size()});
    }
    return topics;
  }

  /// The first message of a topic; null where there is none, or no such topic.
  template <class Message>
  boost::shared_ptr<Message> first(const std::string& topic) const {
    if (topic.empty()) return {};
    rosbag::View view(bag_, rosbag::TopicQuery(topic));
    return view.begin() == view.end() ? nullptr : message_of<Message>(*view.begin());
  }

  std::optional<Camera> camera_in(const std::string& topic, bool rectified) const {
    const auto info = first<ros1::CameraInfo>(topic);
    if (!info) return std::nullopt;
    try {
      Camera camera = camera_of(ros1::values_of(*info), rectified);
      camera.name = topic;
      return camera;
    } catch (const Error& error) {
      spdlog::warn("{}: {}: {}; not used", file_, topic, error.what());
      return std::nullopt;
    }
  }

  /// Images of colour a second, for the camera.
  void note_rate() {
    if (!own_camera_) return;
    rosbag::View view(bag_, rosbag::TopicQuery(topics_.colour));
    const double seconds = (view.getEndTime() - view.getBeginTime()).toSec();
    if (view.size() < 2 || !(seconds > 0.0)) return;
    const double rate = static_cast<double>(view.size() - 1) / seconds;
    // A message that came late makes no other camera of it.
    own_camera_->frame_rate = std::clamp(std::round(rate), 1.0, 1000.0);
  }

  /// Hands the next message to the pairing; false at the end.
  bool take_message() {
    if (next_ == view_->end()) return false;
    const rosbag::MessageInstance& instance = *next_;
    ImageMessage message;
    message.raw = message_of<ros1::Image>(instance);
    if (!message.raw) message.compressed = message_of<ros1::CompressedImage>(instance);
    if (!message.raw && !message.compressed) {
      fail(fmt::format("{}: its {} is not that of ROS 1", instance.getTopic(),
                       instance.getDataType()));
    }
    ros::Time stamp = message.raw ? message.raw->header.stamp : message.compressed->header.stamp;
    if (stamp.isZero()) stamp = instance.getTime();
    if (instance.getTopic() == topics_.colour) {
      pairing_.add_colour(stamp.toSec(), std::move(message));
    } else {
      pairing_.add_depth(stamp.toSec(), std::move(message));
    }
    ++next_;
    return true;
  }

  std::optional<Pair> next_pair() {
    for (;;) {
      if (auto pair = pairing_.next()) return pair;
      if (ended_) return std::nullopt;
      if (!take_message()) {
        ended_ = true;
        pairing_.end();
      }
    }
  }

  /// Throws `Error`, which names file and topic.
  Images images_of(const Pair& pair) const {
    Images images;
    const std::string* topic = &topics_.colour;
    try {
      images.colour = colour_of(pair.colour.view());
      topic = &topics_.depth;
      images.depth = depth_of(pair.depth.view(), units_per_metre_);
    } catch (const Error& error) {
      fail(fmt::format("{}: {}", *topic, error.what()));
    }
    return images;
  }

  std::optional<RgbdFrame> next_frame() {
    for (int in_a_row = 1;; ++in_a_row) {
      const auto pair = first_pair_ ? std::exchange(first_pair_, std::nullopt) : next_pair();
      if (!pair) {
        if (pairing_.unpaired() > 0) {
          spdlog::info("{}: {} colour images without a depth image", file_, pairing_.unpaired());
        }
        return std::nullopt;
      }
      ++index_;
      try {
        return frame_of(*pair);
      } catch (const Error& error) {
        ++skipped_;
        if (in_a_row >= most_skipped_in_a_row) throw;
        spdlog::warn("{}; frame {} skipped", error.what(), index_);
      }
    }
  }

  RgbdFrame frame_of(const Pair& pair) {
    Images images = index_ == 0 ? std::exchange(first_images_, {}) : images_of(pair);
    if (registration_ && images.depth.cols == depth_camera_->width &&
        images.depth.rows == depth_camera_->height) {
      images.depth = registration_->registered(images.depth);
    }
    for (const cv::Mat* image : {&images.colour, &images.depth}) {
      if (image->cols == camera_.width && image->rows == camera_.height) continue;
      fail(fmt::format("{}: an image of {} x {} pixels, not {} x {} as before",
                       image == &images.depth ? topics_.depth : topics_.colour, image->cols,
                       image->rows, camera_.width, camera_.height));
    }
    corrector_.apply(images.depth);
    keep_depth_range(images.depth, camera_.min_depth, camera_.max_depth);
    RgbdFrame frame;
    frame.index = index_;
    frame.timestamp = pair.colour_stamp;
    frame.depth_delay = pair.depth_stamp - pair.colour_stamp + camera_.depth_correction.delay;
    frame.colour = std::move(images.colour);
    frame.depth = std::move(images.depth);
    return frame;
  }

  const std::string file_;
  rosbag::Bag bag_;
  std::unique_ptr<BagRecords> records_;
  CameraTopics topics_;
  double units_per_metre_ = 1000.0;
  std::optional<Camera> own_camera_, depth_camera_;
  std::optional<Se3> colour_from_device_, depth_from_device_;
  Camera camera_;
  DepthCorrector corrector_;
  std::optional<DepthRegistration> registration_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator next_;
  StampPairing<ImageMessage> pairing_;
  std::optional<Pair> first_pair_;
  Images first_images_;
  bool ended_ = false;
  int index_ = -1;  // of the last frame
  std::size_t skipped_ = 0;
};

}  // namespace

bool can_read_bags() { return true; }

std::unique_ptr<BagSource> open_bag(const std::string& file, const BagOptions& options) {
  return std::make_unique<RosBagSource>(file, options);
}

}  // namespace dkp_slam
