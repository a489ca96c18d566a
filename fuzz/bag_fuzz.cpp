// ROS 1 bags: the records, which rosbag itself believes, and the images of the messages.
#include <algorithm>
#include <cmath>

#include "dkp_slam/sensor/bag/bag_source.h"
#include "dkp_slam/sensor/bag/test_bag.h"
#include "fuzz/target.h"
#include "tests/support/file_text.h"

namespace dkp_slam::fuzz {
namespace {

/// A camera's recording: colour, depth and what tells of the camera.
std::string good_bag() {
  const InputFile file({});
  {
    testing::TestBag bag(file.path());
    const cv::Mat colour = testing::TestBag::pattern(), depth(4, 6, CV_16UC1, cv::Scalar(1500));
    bag.info("/camera/rgb/camera_info", 1.0, colour.size(), 5.0);
    for (int i = 0; i < 4; ++i) {
      const double stamp = 1.0 + 0.03 * i;
      bag.image("/camera/rgb/image_color", stamp, colour, "bgr8");
      bag.image("/camera/depth_registered/image", stamp + 0.005, depth, "16UC1");
    }
  }
  return testing::content(file.path());
}

/// RealSense's, whose depth is registered by what the bag says of the two cameras.
std::string good_recording() {
  const InputFile file({});
  {
    testing::TestBag bag(file.path());
    const std::string device = "/device_0/sensor_", data = "_0/image/data",
                      info = "_0/info/camera_info", pose = "_0/tf/0";
    const cv::Mat colour = testing::TestBag::pattern(), depth(4, 6, CV_16UC1, cv::Scalar(1500));
    bag.number(device + "0/option/Depth_Units/value", 0.001F);
    bag.info(device + "0/Depth" + info, 0.0, depth.size(), 5.0);
    bag.info(device + "1/Color" + info, 0.0, colour.size(), 5.0, 0.5);
    bag.transform(device + "0/Depth" + pose, {});
    bag.transform(device + "1/Color" + pose, {Eigen::Quaterniond::Identity(), {0.01, 0.0, 0.0}});
    for (int i = 0; i < 3; ++i) {
      bag.image(device + "0/Depth" + data, 1.0 + 0.03 * i, depth, "mono16");
      bag.image(device + "1/Color" + data, 1.0 + 0.03 * i, colour, "rgb8");
    }
  }
  return testing::content(file.path());
}

/// Most of a bag no mutation has to invent: the input says what to change in a good one, as
/// (place, byte) pairs, and where to cut it off.
void change(std::string& text, Reader& input) {
  const int changes = input.below(12);
  for (int i = 0; i < changes; ++i) {
    const std::size_t at = input.take<std::uint16_t>() % text.size();
    text[at] = input.take<char>();
  }
  if (input.below(8) == 1) text.resize(input.take<std::uint16_t>() % text.size());
}

void play(const std::string& file) {
  const std::unique_ptr<BagSource> source = open_bag(file);
  Camera camera;
  camera.width = 6;
  camera.height = 4;
  camera.fx = camera.fy = 5.0;
  camera.cx = 2.5;
  camera.cy = 1.5;
  source->use_camera(source->own_camera().value_or(camera));
  constexpr int most_frames = 10;
  double last = 0.0;
  for (int i = 0; i < most_frames; ++i) {
    const auto frame = source->read();
    if (!frame) return;
    require(std::isfinite(frame->timestamp), "a time stamp that is no number");
    require(i == 0 || frame->timestamp > last, "time stamps that do not rise");
    last = frame->timestamp;
    require(frame->colour.type() == CV_8UC3 && frame->depth.type() == CV_32FC1 &&
                frame->colour.size() == frame->depth.size(),
            "images of another type or size");
    require(std::all_of(frame->depth.begin<float>(), frame->depth.end<float>(),
                        [](float metres) { return std::isfinite(metres) && metres >= 0.0F; }),
            "depth that is none");
  }
}

void run(Bytes bytes) {
  static const std::string good[] = {good_bag(), good_recording()};
  Reader input(bytes);
  // Two good ones, each with its chunk packed and not; else the input itself.
  const std::size_t choice = input.take<std::uint8_t>() % 6, kind = choice % 3;
  std::string bag;
  if (kind == 2) {
    bag = text_of(input.rest());
  } else if (choice < 2) {
    testing::PlainBag changed(good[kind]);
    change(changed.chunk, input);
    change(changed.index, input);
    bag = changed.packed(input.below(3));
  } else {
    bag = good[kind];
    change(bag, input);
  }
  const InputFile file(bytes_of(bag));
  takes([&] { play(file.path()); });
}

std::vector<std::string> seeds() {
  return {std::string("\0\0\0", 3),
          std::string("\1\0\0", 3),
          std::string("\1\2\144\4\7\30\5\1\0", 9),
          std::string("\0\1\50\6\5\1\20\7", 8),
          std::string("\3\0\0", 3),
          std::string("\4\0\0", 3),
          std::string("\3\2\144\4\7\30\5\1\0", 9),
          std::string("\4\0\0\1\50\6\5\1", 8),
          "\2#ROSBAG V2.0\n"};
}

const Registration registration({"bag", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
