#include "dkp_slam/synth/scenario.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/figure/figure.h"
#include "dkp_slam/synth/moved_things.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

/// How far a place on the floor is from anything that a walking body would hit.
class Obstacles {
 public:
  explicit Obstacles(const Place& place) : free_(size, size, CV_8U, cv::Scalar(255)) {
    for (const Mesh& mesh : place.meshes) {
      for (const Eigen::Vector3i& t : mesh.triangles) add(mesh.rest.vertices, t);
    }
    cv::distanceTransform(free_, distance_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  }
  double distance(const Vector2d& place) const {
    return cell * distance_.at<float>(square(place.y()), square(place.x()));
  }

 private:
  static constexpr double cell = 0.04, from = -4.0;  // metres
  static constexpr int size = 325;                   // cells: to 9 m
  static int square(double at) { return static_cast<int>(std::floor((at - from) / cell)); }
  void add(const std::vector<Eigen::Vector3f>& vertices, const Eigen::Vector3i& t) {
    const auto corner = [&](int i) -> Vector3d {
      return vertices[static_cast<std::size_t>(t[i])].cast<double>();
    };
    const Vector3d a = corner(0), u = corner(1) - a, v = corner(2) - a;
    const int steps = static_cast<int>(std::max(u.norm(), v.norm()) / (0.5 * cell)) + 1;
    for (int i = 0; i <= steps; ++i) {
      for (int k = 0; i + k <= steps; ++k) {
        const Vector3d p = a + u * i / steps + v * k / steps;
        if (p.z() < 0.15 || p.z() > 1.7) continue;
        const cv::Point at(square(p.x()), square(p.y()));
        // Streets seen through windows lie far outside.
        if (cv::Rect(0, 0, size, size).contains(at)) free_.at<std::uint8_t>(at) = 0;
      }
    }
  }
  cv::Mat free_, distance_;
};

const Obstacles& obstacles(bool of_flat) {
  static const auto made = [] {
    cv::RNG first(1), second(1);
    return std::pair(Obstacles(office(first)), Obstacles(flat(second)));
  }();
  return of_flat ? made.second : made.first;
}

/// With seed 1; made once.
const Scenario& scenario_of(const std::string& name) {
  static std::map<std::string, Scenario> made;
  if (made.count(name) == 0) made.emplace(name, make_scenario(name, 1));
  return made.at(name);
}

std::vector<const Figure*> figures_of(const Scenario& scenario) {
  std::vector<const Figure*> figures;
  for (const auto& actor : scenario.actors) {
    if (const auto* figure = dynamic_cast<const Figure*>(actor.get())) figures.push_back(figure);
  }
  return figures;
}

Vector2d place_of(const Figure& figure, double time) {
  return figure.root(time).translation.head<2>();
}

constexpr double minute = 60.0;

/// Nobody comes too near to furniture or to another one within a minute. Furniture is the place's
/// own: not the scenario's chairs, on which people sit and which they push.
void expect_room_to_move(const std::string& name) {
  SCOPED_TRACE(name);
  const std::vector<const Figure*> figures = figures_of(scenario_of(name));
  for (double time = 0.0; time < minute; time += 0.1) {
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const Vector2d here = place_of(*figures[i], time);
      ASSERT_GT(obstacles(name == "flat_loop").distance(here), 0.18)
          << "figure " << i << " at (" << here.transpose() << ") after " << time << " s";
      for (std::size_t k = 0; k < i; ++k) {
        ASSERT_GT((here - place_of(*figures[k], time)).norm(), 0.40)
            << "figures " << i << " and " << k << " after " << time << " s";
      }
    }
  }
}

TEST(Scenario, PeopleDoNotWalkThroughThings) {
  for (const char* name : {"walking_xyz", "sitting_xyz", "crowd", "close_up", "covered_start",
                           "moved_furniture", "flat_loop"}) {
    expect_room_to_move(name);
  }
}

void expect_clear(const Scenario& scenario, const CameraPath& camera) {
  for (const Figure* figure : figures_of(scenario)) {
    for (double time = 0.0; time < minute; time += 0.1) {
      ASSERT_GT((place_of(*figure, time) - camera(time).translation.head<2>()).norm(), 0.38)
          << "after " << time << " s";
    }
  }
}

TEST(Scenario, PeopleKeepClearOfTheCamera) {
  for (const char* name : {"walking_xyz", "crowd"}) {
    for (const SyntheticMotion motion : {SyntheticMotion::xyz, SyntheticMotion::halfsphere}) {
      for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        SCOPED_TRACE(fmt::format("{}, seed {}", name, seed));
        expect_clear(scenario_of(name), hand_motion(motion, seed));
      }
    }
  }
  for (const char* name : {"close_up", "covered_start", "moved_furniture", "flat_loop"}) {
    SCOPED_TRACE(name);
    expect_clear(scenario_of(name), scenario_of(name).camera);
  }
  const Scenario other = make_scenario("close_up", 2);
  expect_clear(other, other.camera);
}

TEST(Scenario, TheCameraIsCarriedThroughTheFlatsDoors) {
  const CameraPath camera = scenario_of("flat_loop").camera;
  for (double time = 0.0; time < minute; time += 0.1) {
    const Vector2d here = camera(time).translation.head<2>();
    ASSERT_GT(obstacles(true).distance(here), 0.20)
        << "(" << here.transpose() << ") after " << time;
  }
}

TEST(Scenario, SomebodyComesCloseUp) {
  const Scenario& scenario = scenario_of("close_up");
  double close = 0.0;  // seconds within 0.7 m
  for (double time = 0.0; time < 20.0; time += 0.1) {
    const double distance = (place_of(*figures_of(scenario).front(), time) -
                             scenario.camera(time).translation.head<2>())
                                .norm();
    if (distance < 0.7) close += 0.1;
  }
  EXPECT_GT(close, 2.5);
}

TEST(Scenario, PeopleDoWhatTheNamesSay) {
  const auto travelled = [](const Figure& figure) {
    double way = 0.0;
    for (double t = 0.0; t < 30.0; t += 0.1) {
      way += (place_of(figure, t + 0.1) - place_of(figure, t)).norm();
    }
    return way;
  };
  const Scenario &walking = scenario_of("walking_xyz"), &sitting = scenario_of("sitting_xyz");
  ASSERT_EQ(figures_of(walking).size(), 2U);
  for (const Figure* figure : figures_of(walking)) EXPECT_GT(travelled(*figure), 4.0);
  ASSERT_EQ(figures_of(sitting).size(), 2U);
  for (const Figure* figure : figures_of(sitting)) EXPECT_LT(travelled(*figure), 0.01);
  EXPECT_EQ(figures_of(scenario_of("crowd")).size(), 5U);
  EXPECT_TRUE(make_scenario("static_room", 1).actors.empty());
  EXPECT_EQ(figures_of(scenario_of("flat_loop")).size(), 1U);
}

/// How far an actor's first vertex has gone from where it was at first, metres.
double moved(const Actor& actor, double time) {
  return (actor.at(time).front().vertices.front() - actor.at(0.0).front().vertices.front()).norm();
}

TEST(Scenario, ABoxIsCarriedAndPutBack) {
  const Scenario& scenario = scenario_of("walking_xyz");
  const Actor& box = *scenario.actors.back();
  EXPECT_EQ(box.class_name(), "");
  EXPECT_EQ(moved(box, 5.0), 0.0);
  double farthest = 0.0;
  bool back = false;
  for (double t = 0.0; t < 40.0; t += 0.1) {
    farthest = std::max(farthest, moved(box, t));
    EXPECT_LT(
        (box.at(t + 0.1).front().vertices.front() - box.at(t).front().vertices.front()).norm(),
        0.25);
    back = back || (farthest > 1.0 && moved(box, t) == 0.0);
  }
  EXPECT_GT(farthest, 1.0);
  EXPECT_TRUE(back);
}

TEST(Scenario, FurnitureMovesWithAndWithoutPeople) {
  const Scenario& scenario = scenario_of("moved_furniture");
  const double end = static_cast<double>(default_frames("moved_furniture")) / 30.0;
  ASSERT_EQ(scenario.actors.size(), 5U);
  const Actor &chair = *scenario.actors[1], &drawer = *scenario.actors[2],
              &box = *scenario.actors[3], &robot = *scenario.actors[4];
  EXPECT_EQ(chair.class_name(), "chair");
  EXPECT_EQ(robot.class_name(), "");
  EXPECT_GT(moved(chair, end), 1.0);
  EXPECT_GT(moved(box, end), 2.0);
  const auto highest = [&](const Actor& actor) {
    double most = 0.0;
    for (double t = 0.0; t < end; t += 0.1) most = std::max(most, moved(actor, t));
    return most;
  };
  EXPECT_NEAR(highest(drawer), 0.36, 0.01);
  EXPECT_NEAR(moved(drawer, end), 0.0, 0.01);
  // The robot has crossed the view before anybody comes in from behind the camera.
  const Figure& person = *figures_of(scenario).front();
  EXPECT_GT(moved(robot, 5.0), 1.5);
  EXPECT_LT(place_of(person, 5.0).y(), -1.5);
}

TEST(Scenario, SameSeedSamePathsOtherSeedOthers) {
  const Scenario &a = scenario_of("walking_xyz"), b = make_scenario("walking_xyz", 1),
                 other = make_scenario("walking_xyz", 2);
  for (double t = 0.0; t < 20.0; t += 1.7) {
    EXPECT_EQ(a.camera(t).translation, b.camera(t).translation);
    EXPECT_NE(a.camera(t).translation, other.camera(t).translation);
    for (std::size_t i = 0; i < a.actors.size(); ++i) {
      const auto poses = a.actors[i]->at(t), again = b.actors[i]->at(t);
      for (std::size_t m = 0; m < poses.size(); ++m) {
        EXPECT_EQ(poses[m].vertices, again[m].vertices);
      }
    }
  }
}

TEST(Scenario, TheLampsGoOffAndOnAgain) {
  const LampBrightness lamps = make_scenario("lights", 1).brightness;
  EXPECT_EQ(lamps(0.0), 1.0);
  EXPECT_EQ(lamps(4.7), 0.0);
  EXPECT_EQ(lamps(5.8), 1.0);
  EXPECT_EQ(lamps(10.7), 0.0);
  EXPECT_FALSE(scenario_of("walking_xyz").brightness);
}

TEST(Scenario, KnowsItsNames) {
  EXPECT_EQ(scenario_names().size(), 14U);
  EXPECT_EQ(scenario_names().front().name, "walking_xyz");
  EXPECT_EQ(default_frames("walking_xyz"), 600U);
  EXPECT_GT(default_frames("flat_loop"), 1000U);
  try {
    make_scenario("flying", 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no scenario \"flying\"; there are walking_xyz, "));
  }
  EXPECT_THROW(default_frames("flying"), Error);
}

TEST(ArrivingFrames, LackSingleOnesAndBursts) {
  const std::vector<std::size_t> frames = arriving_frames(600, 30.0, 3);
  ASSERT_EQ(frames.size(), 600U);
  EXPECT_EQ(frames, arriving_frames(600, 30.0, 3));
  EXPECT_NE(frames, arriving_frames(600, 30.0, 4));
  int singles = 0, bursts = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    ASSERT_GT(frames[i], frames[i - 1]);
    const std::size_t lost = frames[i] - frames[i - 1] - 1;
    if (lost == 1) ++singles;
    if (lost > 1) {
      ++bursts;
      EXPECT_GE(lost, 9U);   // 0.3 seconds
      EXPECT_LE(lost, 31U);  // 1 second
    }
  }
  EXPECT_EQ(frames[29], 29U);
  EXPECT_GT(singles, 8);
  EXPECT_GE(bursts, 3);
}

TEST(MovedThings, StayAtFindsWhenSomebodyComesAndGoes) {
  const auto walker = [](double t) { return Vector2d(std::clamp(t - 2.0, 0.0, 3.0), 0.0); };
  const Stay start = stay_at(walker, {0.0, 0.0});
  EXPECT_EQ(start.arrives, 0.0);
  EXPECT_NEAR(start.leaves, 2.05, 0.011);
  const Stay middle = stay_at(walker, {1.0, 0.0});
  EXPECT_NEAR(middle.arrives, 2.95, 0.011);
  EXPECT_NEAR(middle.leaves, 3.05, 0.011);
  EXPECT_GT(stay_at(walker, {3.0, 0.0}).leaves, 100.0);
  EXPECT_THROW(stay_at(walker, {0.0, 1.0}), Error);
}

TEST(MovedThings, RollsToAndFroHeadFirst) {
  const auto motion = rolling({{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}}, 0.5, 1.0, 4.0);
  const auto at = [&](double t) -> Vector3d { return motion(t).translation; };
  EXPECT_LT(at(0.5).norm(), 0.01);
  EXPECT_LT((at(11.5) - Vector3d(3.0, 2.0, 0.0)).norm(), 0.01);  // 5 m take 10 s
  EXPECT_LT((at(14.9) - Vector3d(3.0, 2.0, 0.0)).norm(), 0.01);
  EXPECT_LT(at(25.1).norm(), 0.01);
  const Vector3d front = motion(4.0).rotation * -Vector3d::UnitY();
  EXPECT_GT(front.x(), 0.99);
  for (double t = 0.0; t < 30.0; t += 0.1) EXPECT_LT((at(t + 0.1) - at(t)).norm(), 0.08);
}

}  // namespace
}  // namespace dkp_slam
