#include "dkp_slam/synth/noise/sensor_effects.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

cv::Mat grey(double radiance) { return {240, 320, CV_32FC3, cv::Scalar::all(radiance)}; }

SensorOptions plain() {
  SensorOptions options;
  options.automatic = false;
  options.gain = 1.0;
  options.vignetting = 0.0;
  options.noise = false;
  return options;
}

double linear(double level) {
  const double c = level / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

TEST(ColourSensor, FollowsTheSrgbCurve) {
  SensorOptions options = plain();
  options.gain = 2.0;
  ColourSensor sensor(options, 1);
  // Published pairs of the curve: linear 0.2140 is 50% grey, 0.0 black, 1.0 white.
  for (const auto& [radiance, level] :
       {std::pair(0.0, 0), {0.2140 / 2.0, 127}, {0.5, 255}, {7.0, 255}, {0.0010, 6}}) {
    const cv::Mat image = sensor.expose(grey(radiance), 0.0);
    EXPECT_NEAR(image.at<cv::Vec3b>(7, 9)[1], level, 1) << radiance;
  }
}

TEST(ColourSensor, CornersAreDarkerByTheVignetting) {
  SensorOptions options = plain();
  options.vignetting = 0.3;
  ColourSensor sensor(options, 1);
  const cv::Mat image = sensor.expose(grey(0.5), 0.0);
  EXPECT_NEAR(linear(image.at<cv::Vec3b>(120, 160)[0]), 0.5, 0.005);
  EXPECT_NEAR(linear(image.at<cv::Vec3b>(0, 0)[0]), 0.35, 0.005);
  EXPECT_NEAR(linear(image.at<cv::Vec3b>(239, 319)[2]), 0.35, 0.005);
  EXPECT_NEAR(linear(image.at<cv::Vec3b>(120, 0)[0]), 0.5 * (1.0 - 0.3 * 0.64), 0.006);
}

TEST(ColourSensor, NoiseIsShotAndReadNoise) {
  SensorOptions options = plain();
  options.noise = true;
  options.gain = 2.0;
  options.electrons = 5000.0;
  options.read_noise = 20.0;
  for (const double radiance : {0.05, 0.2, 0.4}) {
    ColourSensor sensor(options, 3);
    const cv::Mat image = sensor.expose(grey(radiance), 0.0);
    double sum = 0.0, squares = 0.0;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double v = linear(image.at<cv::Vec3b>(y, x)[1]);
        sum += v;
        squares += v * v;
      }
    }
    const auto count = static_cast<double>(image.total());
    const double mean = sum / count, sigma = std::sqrt(squares / count - mean * mean);
    const double expected = 2.0 / 5000.0 * std::sqrt(5000.0 * radiance + 20.0 * 20.0);
    EXPECT_NEAR(mean, 2.0 * radiance, 0.003);
    EXPECT_NEAR(sigma, expected, 0.08 * expected + 0.0005) << radiance;
  }
}

TEST(ColourSensor, ReachesItsTargetAndFollowsAChangeWithInertia) {
  SensorOptions options = plain();
  options.automatic = true;
  options.target = 0.2;
  options.inertia = 0.3;
  options.most_gain = 100.0;
  ColourSensor sensor(options, 1);
  sensor.expose(grey(0.1), 0.0);
  EXPECT_NEAR(sensor.gain(), 2.0, 0.01);
  // The light falls to a quarter: the gain goes to 8, on a scale of powers, 63% of it in 0.3 s.
  for (int i = 1; i <= 9; ++i) sensor.expose(grey(0.025), i / 30.0);
  EXPECT_NEAR(std::log(sensor.gain() / 2.0) / std::log(4.0), 1.0 - std::exp(-1.0), 0.01);
  for (int i = 10; i <= 90; ++i) sensor.expose(grey(0.025), i / 30.0);
  EXPECT_NEAR(sensor.gain(), 8.0, 0.02);
  const cv::Mat image = sensor.expose(grey(0.025), 91 / 30.0);
  EXPECT_NEAR(linear(image.at<cv::Vec3b>(3, 3)[0]), 0.2, 0.003);
}

TEST(ColourSensor, ADarkRoomStaysDark) {
  SensorOptions options = plain();
  options.automatic = true;
  options.most_gain = 12.0;
  ColourSensor sensor(options, 1);
  sensor.expose(grey(0.001), 0.0);
  EXPECT_NEAR(sensor.gain(), 12.0, 1e-9);
}

TEST(ColourSensor, SameSeedSameBytesOnAnyNumberOfThreads) {
  SensorOptions options;
  const int before = cv::getNumThreads();
  const auto second_frame = [&](int threads, std::uint64_t seed) {
    cv::setNumThreads(threads);
    ColourSensor sensor(options, seed);
    sensor.expose(grey(0.1), 0.0);
    return sensor.expose(grey(0.1), 1.0 / 30.0);
  };
  const cv::Mat one = second_frame(1, 5), three = second_frame(3, 5), other = second_frame(1, 6);
  ColourSensor sensor(options, 5);
  const cv::Mat first = sensor.expose(grey(0.1), 0.0);
  cv::setNumThreads(before);
  EXPECT_EQ(cv::norm(one, three, cv::NORM_L1), 0.0);
  EXPECT_GT(cv::norm(one, other, cv::NORM_L1), 0.0);
  EXPECT_GT(cv::norm(one, first, cv::NORM_L1), 0.0) << "every frame has noise of its own";
}

TEST(ColourSensor, RefusesNonsense) {
  SensorOptions options;
  options.electrons = 0.0;
  EXPECT_THROW(ColourSensor(options, 1), Error);
}

}  // namespace
}  // namespace dkp_slam
