#include "dkp_slam/sensor/synthetic/people.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "dkp_slam/sensor/synthetic/figure.h"
#include "dkp_slam/sensor/synthetic/moved_things.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;

// The office: the desk reaches from x = -0.8 to 0.8 and from y = 1.6 to 2.4. The built-in motions
// keep the camera within a metre of (0, -0.85). People walk before the desk (y = 0.4 to 1.1),
// beside it (x = -1.9 and 1.9) and behind it (y = 2.75).
struct Seat {
  Vector2d place;
  double heading;
};
const Seat left_seat{{-1.25, 1.75}, 0.25}, right_seat{{1.25, 1.75}, pi - 0.25};

Activity walk(double x, double y, Gesture gesture = Gesture::none) {
  return {Activity::Kind::walk_to, {x, y}, 0.0, 0.0, gesture};
}
Activity stand(double heading, double seconds, Gesture gesture = Gesture::none) {
  return {Activity::Kind::stand, Vector2d::Zero(), heading, seconds, gesture};
}
Activity sit(const Seat& seat, double seconds, Gesture gesture = Gesture::none) {
  return {Activity::Kind::sit, seat.place, seat.heading, seconds, gesture};
}

FigureOptions seated(const Seat& seat) {
  FigureOptions options;
  options.start = seat.place;
  options.heading = seat.heading;
  options.starts_seated = true;
  options.repeat = true;
  return options;
}
FigureOptions standing(double x, double y, double heading) {
  FigureOptions options;
  options.start = {x, y};
  options.heading = heading;
  options.repeat = true;
  return options;
}

Se3 floor_pose(const Vector2d& place, double turn, double height = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitZ())),
          Vector3d(place.x(), place.y(), height)};
}

/// The `number`-th person of the scenario: looks differ by number and seed.
std::shared_ptr<const Figure> add_person(Scenario& scenario, std::uint64_t seed, int number,
                                         FigureOptions options, std::vector<Activity> activities) {
  options.seed = seed * 16 + static_cast<std::uint64_t>(number);
  options.activities = std::move(activities);
  auto figure = std::make_shared<const Figure>(options);
  scenario.actors.push_back(figure);
  return figure;
}

void add_still(Scenario& scenario, const Se3& pose, const std::vector<Mesh>& meshes) {
  for (const Mesh& mesh : meshes) scenario.place.meshes.push_back(pose * mesh);
}

/// A chair that keeps its place. Furniture's front is at -y.
void add_chair(Scenario& scenario, cv::RNG& rng, const Seat& seat) {
  add_still(scenario, floor_pose(seat.place, seat.heading + 0.5 * pi), office_chair(rng));
}

void add_thing(Scenario& scenario, std::vector<Mesh> meshes, RigidActor::Motion motion,
               const std::string& class_name = "") {
  scenario.actors.push_back(
      std::make_shared<const RigidActor>(std::move(meshes), std::move(motion), class_name));
}

cv::RNG generator(std::uint64_t seed) { return cv::RNG(seed * 48271 + 11); }

}  // namespace

void two_walk(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  add_chair(scenario, rng, left_seat);
  add_chair(scenario, rng, right_seat);
  add_person(scenario, seed, 1, seated(left_seat),
             {sit(left_seat, 2.0, Gesture::talk), walk(-1.2, 1.0), walk(1.25, 0.8),
              stand(2.2, 1.2, Gesture::talk), walk(1.95, 1.0), walk(1.95, 2.75), walk(-1.95, 2.75),
              walk(-1.95, 1.2), sit(left_seat, 5.0, Gesture::talk)});
  const Vector2d at_box(0.5, 1.2);
  const auto porter =
      add_person(scenario, seed, 2, seated(right_seat),
                 {sit(right_seat, 6.5, Gesture::talk), walk(1.2, 1.1), walk(at_box.x(), at_box.y()),
                  stand(0.5 * pi, 1.6), walk(-0.7, 0.55, Gesture::carry),
                  stand(2.4, 1.5, Gesture::carry), walk(at_box.x(), at_box.y(), Gesture::carry),
                  stand(0.5 * pi, 1.4), walk(1.2, 1.1), sit(right_seat, 3.0, Gesture::phone)});
}

void two_sit(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  add_chair(scenario, rng, left_seat);
  add_chair(scenario, rng, right_seat);
  add_person(scenario, seed, 1, seated(left_seat),
             {sit(left_seat, 4.0, Gesture::talk), sit(left_seat, 2.5, Gesture::point),
              sit(left_seat, 3.0, Gesture::none), sit(left_seat, 6.0, Gesture::talk),
              sit(left_seat, 5.0, Gesture::type)});
  add_person(scenario, seed, 2, seated(right_seat),
             {sit(right_seat, 5.0, Gesture::type), sit(right_seat, 6.0, Gesture::phone),
              sit(right_seat, 4.0, Gesture::talk), sit(right_seat, 1.5, Gesture::wave)});
}

}  // namespace dkp_slam
