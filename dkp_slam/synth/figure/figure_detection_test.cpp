#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/detection/factory/detector_factory.h"
#include "dkp_slam/synth/figure/figure.h"
#include "dkp_slam/synth/render/renderer.h"

namespace dkp_slam {
namespace {

using Eigen::Vector3d;

/// Level, from `eye`, x to the right.
Se3 looking_along_y(const Vector3d& eye) {
  Eigen::Matrix3d axes;
  axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return {Eigen::Quaterniond(axes), eye};
}

/// People of several seeds who take their turn in front of the camera, two seconds each.
class OneByOne : public Actor {
 public:
  OneByOne(const FigureOptions& options, int turn) : figure_(options), turn_(turn) {}
  const std::vector<Mesh>& meshes() const override { return figure_.meshes(); }
  std::string class_name() const override { return figure_.class_name(); }
  std::vector<MeshPose> at(double time) const override {
    const bool on = static_cast<int>(std::floor(time / 2.0)) == turn_;
    const Se3 place(Eigen::Quaterniond::Identity(), Vector3d(0.0, 0.0, on ? 0.0 : -100.0));
    std::vector<MeshPose> poses = figure_.at(time - 2.0 * turn_ + 5.0);
    for (MeshPose& pose : poses) pose = place * pose;
    return poses;
  }

 private:
  Figure figure_;
  int turn_;
};

std::vector<std::shared_ptr<const Actor>> people() {
  using Kind = Activity::Kind;
  const std::vector<Gesture> gestures = {Gesture::none, Gesture::talk, Gesture::phone,
                                         Gesture::carry};
  std::vector<std::shared_ptr<const Actor>> actors;
  for (int i = 0; i < 12; ++i) {
    FigureOptions options;
    options.seed = static_cast<std::uint64_t>(i + 20);
    options.start = {-0.6 + 0.4 * (i % 4), 0.2 + 0.25 * (i % 5)};
    options.heading = 2.1 * i;
    Activity activity;
    activity.heading = options.heading;
    activity.gesture = gestures[static_cast<std::size_t>(i) % gestures.size()];
    if (i % 3 == 1) {
      options.starts_seated = true;
      activity = {Kind::sit, options.start, options.heading, 0.0, Gesture::type};
    }
    options.activities = {activity};
    if (i % 3 == 2) {  // passes in the seventh second
      const Eigen::Vector2d way(std::cos(options.heading), std::sin(options.heading));
      options.start -= 6.0 * options.walking_speed * way;
      options.activities = {{Kind::walk_to, options.start + 20.0 * way, 0.0, 0.0, Gesture::none}};
    }
    actors.push_back(std::make_shared<OneByOne>(options, i));
  }
  return actors;
}

cv::Mat photograph(const cv::Mat& radiance) {
  cv::Mat image;
  const cv::Scalar mean = cv::mean(radiance);
  cv::pow(radiance * (0.66 / (mean[0] + mean[1] + mean[2])), 1.0 / 2.2, image);
  image.convertTo(image, CV_8UC3, 255.0);
  return image;
}

bool seen(const std::vector<Detection>& found, const cv::Rect& box) {
  for (const Detection& d : found) {
    if (ClassTable::name(d.class_id) != std::string_view("person")) continue;
    const cv::Rect2d a = d.box, b = box;
    const double both = (a & b).area();
    if (both >= 0.5 * (a.area() + b.area() - both)) return true;
  }
  return false;
}

/// What the figures are for: the detector that runs on photographs takes them for people.
TEST(FigureDetection, YoloxSeesPeople) {
  const char* model = std::getenv("DKP_SLAM_MODEL");
  if (model == nullptr) GTEST_SKIP() << "DKP_SLAM_MODEL names no YOLOX model";
  cv::RNG rng(7);
  const std::vector<std::shared_ptr<const Actor>> actors = people();
  const Renderer renderer(office(rng), actors);
  Camera camera;
  camera.fx = camera.fy = 535.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  YoloxOptions options;
  options.model = model;
  options.decode.lowest_score = 0.3F;
  const std::unique_ptr<Detector> detector = make_yolox_detector(options);
  RenderOptions quick;
  quick.samples = 1;
  int large = 0, recalled = 0;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    const Se3 pose = looking_along_y({0.0, -1.9, 1.25});
    const Rendering rendering = renderer.render(
        camera, [&](double) { return pose; }, 2.0 * static_cast<double>(i) + 1.0, quick);
    const cv::Mat mask = rendering.instance == static_cast<int>(i + 1);
    if (cv::countNonZero(mask) < 0.05 * 640 * 480) continue;
    ++large;
    RgbdFrame frame;
    frame.colour = photograph(rendering.radiance);
    recalled += seen(detector->detect(frame), cv::boundingRect(mask)) ? 1 : 0;
  }
  EXPECT_GE(large, 6);
  EXPECT_GE(recalled, 0.8 * large);
}

}  // namespace
}  // namespace dkp_slam
