#include "dkp_slam/synth/render/renderer.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera small_camera() {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 270.0;
  camera.cx = 160.3;
  camera.cy = 119.8;
  return camera;
}

TexturePtr plain(int level) {
  return std::make_shared<Texture>(cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(level)));
}

/// At `from`, looking along +y, x to the right, z up.
Se3 ahead(const Vector3d& from) {
  Eigen::Matrix3d axes;
  axes << Vector3d::UnitX(), -Vector3d::UnitZ(), Vector3d::UnitY();
  return {Eigen::Quaterniond(axes), from};
}

std::function<Se3(double)> still(const Se3& pose) {
  return [pose](double) { return pose; };
}

/// A wall across the view at y = `distance`; the texture upright.
Mesh wall(double distance, TexturePtr texture, double half = 6.0) {
  return panel_mesh({-half, distance, half}, {2 * half, 0, 0}, {0, 0, -2 * half},
                    std::move(texture));
}

std::shared_ptr<const Actor> resting(const Mesh& mesh, const Se3& pose) {
  return std::make_shared<RigidActor>(std::vector<Mesh>{mesh}, still(pose));
}

Rendering render_once(std::vector<Mesh> meshes, std::vector<std::shared_ptr<const Actor>> actors,
                      const std::function<Se3(double)>& pose, const RenderOptions& options = {},
                      const Camera& camera = small_camera()) {
  const Renderer renderer({std::move(meshes), {}}, std::move(actors));
  return renderer.render(camera, pose, 0.0, options);
}

/// Column, with parts of a pixel, at which a row of `image` crosses `level`.
double crossing(const cv::Mat& image, int y, double level) {
  const auto* row = image.ptr<cv::Vec3f>(y);
  for (int x = 0; x + 1 < image.cols; ++x) {
    const double a = row[x][1], b = row[x + 1][1];
    if ((a < level) != (b < level)) return x + (level - a) / (b - a);
  }
  return -1.0;
}

TEST(Renderer, DepthOfATiltedPlaneIsAnalytic) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vector3d(0.2, 0.9, -0.4).normalized()));
  Se3 pose = ahead({0.3, -0.2, 0.1});
  pose.rotation = pose.rotation * turn;
  const Rendering seen = render_once({wall(2.5, plain(100))}, {}, still(pose));
  int checked = 0;
  for (int y = 0; y < 240; y += 3) {
    for (int x = 0; x < 320; x += 3) {
      const Vector3d ray = pose.rotation * small_camera().unproject(Vector2d(x, y), 1.0);
      const double depth = (2.5 - pose.translation.y()) / ray.y();
      ASSERT_NEAR(seen.depth.at<float>(y, x), depth, 1e-4 * depth) << x << " " << y;
      ++checked;
    }
  }
  EXPECT_GT(checked, 8000);
  EXPECT_EQ(cv::countNonZero(seen.instance), 0);
}

TEST(Renderer, LensDistortionBendsTheRays) {
  Camera camera = small_camera();
  camera.distortion = {0.2, -0.3, 0.002, -0.001, 0.1};
  const Rendering seen =
      render_once({wall(2.0, plain(100))}, {},
                  still({ahead({0, 0, 0}).rotation *
                             Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitY())),
                         {0, 0, 0}}),
                  {}, camera);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Vector3d::UnitY()));
  for (const Vector2d& ideal : {Vector2d(40, 50), Vector2d(280, 190), Vector2d(160, 20)}) {
    const Vector2d raw = camera.distort(ideal);
    ASSERT_GT((raw - ideal).norm(), 0.5);
    // Depth at the raw pixel, between its four neighbours.
    cv::Mat depth;
    cv::getRectSubPix(seen.depth, {1, 1},
                      {static_cast<float>(raw.x()), static_cast<float>(raw.y())}, depth);
    const Vector3d ray = turn * camera.unproject(ideal, 1.0);
    EXPECT_NEAR(depth.at<float>(0, 0), 2.0 / ray.z(), 1e-3);
  }
}

TEST(Renderer, DepthAndInstanceOfABoxAndABallAreAnalytic) {
  const Se3 camera_pose = ahead({0, 0, 0});
  const Se3 box_pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())),
                     {-0.5, 2.0, 0.1});
  const Vector3d half(0.3, 0.2, 0.25), ball(0.55, 2.2, -0.1);
  constexpr double radius = 0.4;
  const Rendering seen =
      render_once({wall(4.0, plain(100))},
                  {resting(box_mesh(2.0 * half, plain(50)), box_pose),
                   resting(ellipsoid_mesh(Vector3d::Constant(radius), 400, plain(200)),
                           Se3(Eigen::Quaterniond::Identity(), ball))},
                  still(camera_pose));
  int on_box = 0, on_ball = 0;
  for (int y = 1; y < 239; y += 2) {
    for (int x = 1; x < 319; x += 2) {
      const Vector3d ray = camera_pose.rotation * small_camera().unproject(Vector2d(x, y), 1.0);
      // The box: slabs in its own frame (Kay and Kajiya 1986).
      const Vector3d origin = box_pose.inverse() * Vector3d(0, 0, 0);
      const Vector3d along = box_pose.rotation.conjugate() * ray;
      double enter = -1e9, leave = 1e9;
      for (int a = 0; a < 3; ++a) {
        const double t0 = (-half[a] - origin[a]) / along[a], t1 = (half[a] - origin[a]) / along[a];
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
      }
      const double b = ray.dot(ball), c = ball.squaredNorm() - radius * radius;
      const double root = b * b - ray.squaredNorm() * c;
      const int instance = seen.instance.at<std::uint8_t>(y, x);
      const float depth = seen.depth.at<float>(y, x);
      if (leave - enter > 0.01) {
        EXPECT_EQ(instance, 1);
        EXPECT_NEAR(depth, enter, 1e-4);
        ++on_box;
      } else if (root > 0.05) {
        EXPECT_EQ(instance, 2);
        EXPECT_NEAR(depth, (b - std::sqrt(root)) / ray.squaredNorm(), 1e-4);
        ++on_ball;
      } else if (leave < enter && root < -0.02) {
        EXPECT_EQ(instance, 0);
        EXPECT_NEAR(depth, 4.0, 1e-4);
      }
    }
  }
  EXPECT_GT(on_box, 500);
  EXPECT_GT(on_ball, 1000);
}

TEST(Renderer, TextureColoursComeOutWhereTheyShould) {
  cv::Mat print(256, 256, CV_8UC3);
  const cv::Scalar colours[4] = {{250, 10, 60}, {20, 240, 90}, {30, 60, 220}, {128, 128, 128}};
  for (int i = 0; i < 4; ++i) {
    print(cv::Rect(i % 2 * 128, i / 2 * 128, 128, 128)).setTo(colours[i]);
  }
  const Rendering seen =
      render_once({wall(2.0, std::make_shared<Texture>(print), 1.0)}, {}, still(ahead({0, 0, 0})));
  const Camera camera = small_camera();
  for (int i = 0; i < 4; ++i) {
    const Vector3d point(i % 2 == 0 ? -0.5 : 0.5, i / 2 == 0 ? -0.4 : 0.4, 2.0);  // camera's frame
    const Vector2d pixel = camera.project(point);
    const auto& seen_colour = seen.radiance.at<cv::Vec3f>(cvRound(pixel.y()), cvRound(pixel.x()));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(seen_colour[c], linear_light(static_cast<float>(colours[i][c])), 2e-3);
    }
  }
  // Beside the picture there is nothing.
  EXPECT_EQ(seen.depth.at<float>(120, 5), 0.0F);
  EXPECT_EQ(seen.radiance.at<cv::Vec3f>(120, 5), cv::Vec3f(0, 0, 0));
}

/// Black on the left, white on the right, an edge in the middle: as a print or as two walls.
std::vector<Mesh> edge_scene(bool printed) {
  if (printed) {
    cv::Mat print(8, 4096, CV_8UC3, cv::Scalar::all(0));
    print.colRange(2048, 4096).setTo(cv::Scalar::all(255));
    return {wall(2.0, std::make_shared<Texture>(print), 2.0)};
  }
  return {panel_mesh({-2, 2, 2}, {2, 0, 0}, {0, 0, -4}, plain(0)),
          panel_mesh({0, 2, 2}, {2, 0, 0}, {0, 0, -4}, plain(255))};
}

std::function<Se3(double)> gliding(double speed) {
  return [speed](double time) { return ahead({speed * time, 0, 0}); };
}

TEST(Renderer, RollingShutterSkewsByTheWayOfTheReadout) {
  RenderOptions options;
  options.readout = 0.03;
  constexpr double speed = 1.0;
  const double way = small_camera().fx * speed * options.readout / 2.0;  // pixels
  const Rendering seen = render_once(edge_scene(true), {}, gliding(speed), options);
  // Textures are filtered as they are stored: half of white is a light of 0.214.
  constexpr double half = 0.214;
  const double top = crossing(seen.radiance, 0, half), middle = crossing(seen.radiance, 120, half);
  const double bottom = crossing(seen.radiance, 239, half);
  // The camera goes to the right, the edge to the left, later rows see it farther left.
  EXPECT_NEAR(top - bottom, way, 0.1);
  EXPECT_NEAR(middle, small_camera().cx, 0.25);  // the ramp in between is no straight line
}

TEST(Renderer, RollingShutterSkewsWhatMoves) {
  RenderOptions options;
  options.readout = 0.03;
  options.exposure = 0.005;
  constexpr double speed = 2.0;
  const auto board = std::make_shared<RigidActor>(
      std::vector<Mesh>{panel_mesh({0, 0, 2}, {1, 0, 0}, {0, 0, -4}, plain(255))}, [](double time) {
        return Se3(Eigen::Quaterniond::Identity(), {speed * time, 2.0, 0.0});
      });
  const Rendering seen =
      render_once({wall(4.0, plain(0))}, {board}, still(ahead({0, 0, 0})), options);
  const auto first = [&](int y) {
    int x = 0;
    while (x < 319 && seen.instance.at<std::uint8_t>(y, x) == 0) ++x;
    return x;
  };
  const double way = small_camera().fx * speed * options.readout / 2.0;
  EXPECT_NEAR(first(239) - first(0), way, 1.01);
  EXPECT_NEAR(first(120), small_camera().cx, 1.01);
  EXPECT_NEAR(crossing(seen.radiance, 239, 0.5) - crossing(seen.radiance, 0, 0.5), way, 1.0);
}

TEST(Renderer, MotionBlurIsAsWideAsTheWayOfTheExposure) {
  RenderOptions options;
  options.exposure = 0.03;
  options.samples = 4;
  constexpr double speed = 2.0;
  const double way = small_camera().fx * speed * options.exposure / 2.0;  // 8 pixels
  for (const bool printed : {true, false}) {
    const Rendering sharp = render_once(edge_scene(printed), {}, gliding(0.0), options);
    const Rendering seen = render_once(edge_scene(printed), {}, gliding(speed), options);
    double width = 0.0, sharp_width = 0.0, middle = 0.0;
    constexpr int rows = 40;
    for (int y = 100; y < 100 + rows; ++y) {
      width += crossing(seen.radiance, y, 0.9) - crossing(seen.radiance, y, 0.1);
      sharp_width += crossing(sharp.radiance, y, 0.9) - crossing(sharp.radiance, y, 0.1);
      middle += crossing(seen.radiance, y, 0.5);
    }
    // From 10% to 90% of a ramp.
    EXPECT_NEAR(width / rows, 0.8 * way, 1.0) << printed;
    EXPECT_LT(sharp_width / rows, 1.2) << printed;
    EXPECT_NEAR(middle / rows, small_camera().cx, 0.6) << printed;
  }
}

TEST(Renderer, MovingThingsBlurWhileTheRestIsSharp) {
  RenderOptions options;
  options.exposure = 0.03;
  constexpr double speed = 2.0;
  const auto board = std::make_shared<RigidActor>(
      std::vector<Mesh>{panel_mesh({0, 0, 2}, {1, 0, 0}, {0, 0, -4}, plain(255))}, [](double time) {
        return Se3(Eigen::Quaterniond::Identity(), {speed * time, 2.0, 0.0});
      });
  const Rendering seen =
      render_once({wall(4.0, plain(0))}, {board}, still(ahead({0, 0, 0})), options);
  double width = 0.0;
  constexpr int rows = 40;
  for (int y = 100; y < 100 + rows; ++y) {
    width += crossing(seen.radiance, y, 0.9) - crossing(seen.radiance, y, 0.1);
  }
  EXPECT_NEAR(width / rows, 0.8 * small_camera().fx * speed * options.exposure / 2.0, 1.5);
  // The mask belongs to the middle of the exposure.
  EXPECT_EQ(seen.instance.at<std::uint8_t>(120, 159), 0);
  EXPECT_EQ(seen.instance.at<std::uint8_t>(120, 162), 1);
}

TEST(Renderer, ATableShadesTheFloorAndLampsCanGoOut) {
  const Mesh floor = panel_mesh({-3, -1, 0}, {6, 0, 0}, {0, 5, 0}, plain(200));
  const Mesh board =
      Se3(Eigen::Quaterniond::Identity(), {0, 2, 1}) * box_mesh({0.5, 0.5, 0.05}, plain(200));
  const Renderer renderer({{floor, board}, {{0, 2, 2.6}}}, {},
                          [](double time) { return time < 1.0 ? 1.0 : 0.0; });
  // Straight down from beside the table's edge and below it.
  const Se3 pose(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX())),
                 {0.35, 2.0, 0.9});
  const Rendering lit = renderer.render(small_camera(), still(pose), 0.0, {});
  const Rendering dark = renderer.render(small_camera(), still(pose), 2.0, {});
  const Camera camera = small_camera();
  const auto at = [&](const Rendering& seen, double x) {
    const Vector2d pixel = camera.project({x - 0.35, 0.0, 0.9});
    return seen.radiance.at<cv::Vec3f>(cvRound(pixel.y()), cvRound(pixel.x()))[1];
  };
  EXPECT_LT(at(lit, 0.0), 0.25F * at(lit, 0.85)) << "under the table";
  EXPECT_LT(at(dark, 0.85), 0.15F * at(lit, 0.85));
  EXPECT_GT(at(dark, 0.85), 0.0F) << "a little light always comes in";
}

TEST(Renderer, SameBytesOnAnyNumberOfThreads) {
  cv::RNG rng(3);
  const Place place = office(rng);
  const auto ball = std::make_shared<RigidActor>(
      std::vector<Mesh>{ellipsoid_mesh({0.3, 0.3, 0.8}, 60, plain(120))}, [](double time) {
        return Se3(Eigen::Quaterniond::Identity(), {0.4 * time - 0.3, 1.0, 0.8});
      });
  RenderOptions options;
  options.exposure = 0.01;
  options.readout = 0.02;
  const auto path = [](double time) { return ahead({0.3 * time, 0.1 * time, 1.4}); };
  const int before = cv::getNumThreads();
  std::optional<Rendering> first;
  for (const int threads : {1, 2}) {
    cv::setNumThreads(threads);
    const Renderer renderer(place, {ball});
    const Rendering seen = renderer.render(small_camera(), path, 0.5, options);
    if (!first) first = seen;
    EXPECT_EQ(cv::norm(first->radiance, seen.radiance, cv::NORM_L1), 0.0);
    EXPECT_EQ(cv::norm(first->depth, seen.depth, cv::NORM_L1), 0.0);
    EXPECT_EQ(cv::norm(first->instance, seen.instance, cv::NORM_L1), 0.0);
  }
  cv::setNumThreads(before);
}

TEST(Renderer, RefusesNonsense) {
  const Renderer renderer({{wall(2.0, plain(9))}, {}}, {});
  RenderOptions options;
  options.samples = 0;
  EXPECT_THROW(renderer.render(small_camera(), gliding(0.0), 0.0, options), Error);
  options.samples = 4;
  options.exposure = -1.0;
  EXPECT_THROW(renderer.render(small_camera(), gliding(0.0), 0.0, options), Error);
  EXPECT_THROW(renderer.render(Camera(), gliding(0.0), 0.0, {}), Error);
  Mesh broken = wall(2.0, plain(9));
  broken.uv.pop_back();
  EXPECT_THROW(Renderer({{broken}, {}}, {}), Error);
}

}  // namespace
}  // namespace dkp_slam
