#include "dkp_slam/synth/people.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/figure/figure.h"
#include "dkp_slam/synth/figure/figure_script.h"
#include "dkp_slam/synth/moved_things.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr double desk_top = 0.74;  // metres
// Carried things come and go for so long, seconds; then they stay where they are.
constexpr double carried_for = 600.0;

// The office's floor as furniture leaves it free: the desk reaches from x = -0.95 to 0.95 and from
// y = 1.65 to 2.45, with a chair before it at (-0.25, 1.43); a second desk is left of x = -1.93,
// its chair at (-1.56, 0.65); cupboards are right of x = 2.2; a plant bars the way behind the desk
// at x = -1.15. The built-in motions keep the camera within 1 m of (0, -1.3).
struct Seat {
  Vector2d place;
  double heading;
};
const Seat left_seat{{-1.15, 1.25}, 0.3}, right_seat{{1.20, 1.25}, pi - 0.3};

Activity walk(double x, double y, Gesture gesture = Gesture::none) {
  return {Activity::Kind::walk_to, {x, y}, 0.0, 0.0, gesture};
}
Activity walk(const Vector2d& place, Gesture gesture = Gesture::none) {
  return walk(place.x(), place.y(), gesture);
}
Activity stand(double heading, double seconds, Gesture gesture = Gesture::none) {
  return {Activity::Kind::stand, Vector2d::Zero(), heading, seconds, gesture};
}
Activity sit(const Seat& seat, double seconds, Gesture gesture = Gesture::none) {
  return {Activity::Kind::sit, seat.place, seat.heading, seconds, gesture};
}

FigureOptions seated(const Seat& seat, std::vector<Activity> activities) {
  FigureOptions options;
  options.start = seat.place;
  options.heading = seat.heading;
  options.starts_seated = true;
  options.activities = std::move(activities);
  options.repeat = true;
  return options;
}
FigureOptions standing(const Vector2d& place, double heading, std::vector<Activity> activities) {
  FigureOptions options;
  options.start = place;
  options.heading = heading;
  options.activities = std::move(activities);
  options.repeat = true;
  return options;
}

PlaceOverTime places_of(const FigureOptions& options) {
  auto script = std::make_shared<const FigureScript>(options);
  return [script](double time) { return script->place(time); };
}

/// The script with its last activity so much longer that it takes `period` seconds: people whose
/// scripts have the same period never get into each other's way.
FigureOptions with_period(FigureOptions options, double period) {
  const PlaceOverTime places = places_of(options);
  const Vector2d home = places(0.0);
  const Stay first = stay_at(places, home);
  const Stay second = stay_at(places, home, first.leaves + 1.0);
  const double spare = period - (second.leaves - first.leaves);
  if (spare < 0.0) {
    throw Error(
        fmt::format("scenario: a script takes {:.1f} s longer than {:.1f} s", -spare, period));
  }
  options.activities.back().seconds += spare;
  return options;
}

/// Turned about the vertical, on the floor or above it.
Se3 upright(const Vector2d& place, double turn, double height = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitZ())),
          Vector3d(place.x(), place.y(), height)};
}

/// The `number`-th person of the scenario: looks differ by number and seed.
std::shared_ptr<const Figure> add_person(Scenario& scenario, std::uint64_t seed, int number,
                                         FigureOptions options) {
  options.seed = seed * 16 + static_cast<std::uint64_t>(number);
  auto figure = std::make_shared<const Figure>(options);
  scenario.actors.push_back(figure);
  return figure;
}

void add_thing(Scenario& scenario, std::vector<Mesh> meshes, RigidActor::Motion motion,
               const std::string& class_name = "") {
  scenario.actors.push_back(
      std::make_shared<const RigidActor>(std::move(meshes), std::move(motion), class_name));
}

void add_furniture(Scenario& scenario, const Se3& pose, const std::vector<Mesh>& meshes) {
  for (const Mesh& mesh : meshes) scenario.place.meshes.push_back(pose * mesh);
}

/// A chair that keeps its place. Furniture's front is at -y.
void add_seat(Scenario& scenario, cv::RNG& rng, const Seat& seat) {
  add_furniture(scenario, upright(seat.place, seat.heading + 0.5 * pi), office_chair(rng));
}

cv::RNG generator(std::uint64_t seed) { return cv::RNG(seed * 48271 + 11); }

// What is carried: as wide as two hands are apart; held a hand's breadth below its top.
const Vector3d box_size(0.26, 0.18, 0.16);
const Vector2d before_box(0.42, 1.2), box_place(0.42, 1.75);
const Se3 box_at_rest = upright(box_place, 0.0, desk_top);
const Se3 box_in_hands = upright({0.06, 0.0}, -0.5 * pi, -0.10);

}  // namespace

void two_walk(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  add_seat(scenario, rng, left_seat);
  add_seat(scenario, rng, right_seat);
  // In the recordings people walk and stand about a metre from the camera, where they fill a third
  // of the view: what a camera must not follow.
  constexpr double period = 40.0;  // seconds
  const FigureOptions walker = with_period(
      seated(left_seat, {sit(left_seat, 1.0, Gesture::talk), walk(-0.70, 0.75), walk(0.0, -0.20),
                         stand(0.4 * pi, 1.0, Gesture::point), walk(1.20, -0.15), walk(1.68, 0.90),
                         walk(1.68, 2.85), walk(-0.45, 2.85), stand(0.5 * pi, 0.5, Gesture::point),
                         walk(1.68, 2.85), walk(1.68, 0.80), walk(1.20, -0.20), walk(-0.90, -0.20),
                         stand(1.2, 1.0, Gesture::talk), walk(-0.70, 0.75),
                         sit(left_seat, 2.0, Gesture::talk)}),
      period);
  add_person(scenario, seed, 1, walker);
  const FigureOptions porting = with_period(
      seated(right_seat,
             {sit(right_seat, 5.0, Gesture::talk), walk(before_box),
              stand(0.5 * pi, 1.4, Gesture::carry), walk(0.45, -0.10, Gesture::carry),
              walk(-0.75, -0.15, Gesture::carry), stand(0.9, 1.0, Gesture::carry),
              walk(0.30, 0.30, Gesture::carry), walk(before_box, Gesture::carry),
              stand(0.5 * pi, 1.4), walk(0.20, 0.10), stand(-0.5 * pi, 1.5, Gesture::phone),
              walk(0.95, 0.75), sit(right_seat, 3.0, Gesture::phone)}),
      period);
  const auto porter = add_person(scenario, seed, 2, porting);
  std::vector<Carriage> carriages;
  const PlaceOverTime places = places_of(porting);
  while (carriages.empty() || carriages.back().to < carried_for) {
    const double after = carriages.empty() ? 0.0 : carriages.back().to + 2.0;
    const Stay takes = stay_at(places, before_box, after);
    const Stay puts = stay_at(places, before_box, takes.leaves + 1.0);
    carriages.push_back({takes.leaves - 0.2, puts.arrives + 0.5, box_at_rest, box_at_rest});
  }
  add_thing(scenario, cardboard_box(rng, box_size), carried(porter, box_in_hands, carriages));
}

void two_sit(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  add_seat(scenario, rng, left_seat);
  add_seat(scenario, rng, right_seat);
  add_person(
      scenario, seed, 1,
      seated(left_seat, {sit(left_seat, 4.0, Gesture::talk), sit(left_seat, 2.5, Gesture::point),
                         sit(left_seat, 3.0), sit(left_seat, 6.0, Gesture::talk),
                         sit(left_seat, 5.0, Gesture::type)}));
  add_person(
      scenario, seed, 2,
      seated(right_seat, {sit(right_seat, 3.0, Gesture::type), sit(right_seat, 6.0, Gesture::phone),
                          sit(right_seat, 4.0, Gesture::talk), sit(right_seat, 1.5, Gesture::wave),
                          sit(right_seat, 3.0)}));
}

void crowd(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  add_seat(scenario, rng, left_seat);
  add_seat(scenario, rng, right_seat);
  add_person(
      scenario, seed, 1,
      seated(left_seat, {sit(left_seat, 5.0, Gesture::talk), sit(left_seat, 4.0, Gesture::point)}));
  add_person(
      scenario, seed, 2,
      seated(right_seat, {sit(right_seat, 2.0, Gesture::phone), walk(0.95, 0.75), walk(1.68, 0.80),
                          walk(1.68, 2.85), walk(-0.40, 2.85), stand(0.5 * pi, 2.0, Gesture::point),
                          walk(1.68, 2.85), walk(1.68, 0.80), walk(0.95, 0.75),
                          sit(right_seat, 3.0, Gesture::talk)}));
  // Three lanes: nobody leaves his own.
  add_person(scenario, seed, 3,
             standing({-0.90, 0.75}, 0.0,
                      {walk(0.25, 0.85), stand(1.2, 1.0, Gesture::talk), walk(-0.90, 0.75),
                       stand(2.0, 1.5, Gesture::wave)}));
  FigureOptions near = standing(
      {1.90, 0.20}, pi,
      {walk(-1.10, 0.20), stand(0.6, 0.5), walk(1.90, 0.20), stand(2.4, 0.7, Gesture::phone)});
  near.walking_speed = 1.3;
  add_person(scenario, seed, 4, near);
  add_person(scenario, seed, 5,
             standing({-1.60, 1.80}, -0.9,
                      {stand(-0.9, 4.0, Gesture::talk), stand(-0.4, 3.0, Gesture::phone)}));
}

void close_up(std::uint64_t seed, Scenario& scenario) {
  const Vector2d door(1.90, 0.30);
  FigureOptions options = standing(door, pi, {stand(pi, 1.0)});
  options.repeat = false;
  // In front of the camera as it moves between two moments, `margin` metres away at the nearest.
  const auto before_camera = [&](double from, double to, double margin) -> Vector2d {
    double nearest = -10.0, x = 0.0;
    int count = 0;
    for (double time = from; time <= to; time += 0.1, ++count) {
      const Vector3d camera = scenario.camera(std::max(time, 0.0)).translation;
      nearest = std::max(nearest, camera.y());
      x += camera.x();
    }
    return {x / count, nearest + margin};
  };
  for (double from = 0.0; from < carried_for;) {
    const double lane = before_camera(from, from + 10.0, 0.75).y();
    const auto visiting = [&](const Vector2d& place) {
      FigureOptions visit = options;
      for (const Activity& a :
           {walk(-1.0, lane), stand(-1.0, 0.3), walk(place), stand(-0.5 * pi, 4.0, Gesture::phone),
            walk(0.9, 0.3), walk(door), stand(pi, 1.5, Gesture::phone)}) {
        visit.activities.push_back(a);
      }
      return visit;
    };
    // Where the camera will be depends on when he comes, and that on where to: two rounds do.
    Vector2d place(0.0, -0.4);
    for (int round = 0; round < 2; ++round) {
      const Stay stay = stay_at(places_of(visiting(place)), place, from);
      place = before_camera(stay.arrives - 0.8, stay.leaves + 0.8, 0.42);
    }
    options = visiting(place);
    const PlaceOverTime places = places_of(options);
    from = stay_at(places, door, stay_at(places, place, from).leaves).arrives;
  }
  add_person(scenario, seed, 1, options);
}

void covered_start(std::uint64_t seed, Scenario& scenario) {
  constexpr double in_motion = 3.0;  // seconds since the camera was at rest
  scenario.camera = [path = scenario.camera](double time) { return path(time + in_motion); };
  // Where the camera looks while he stands there, an arm's length ahead; hands that reach out would
  // hide all.
  constexpr double stays = 3.0;  // seconds
  Vector2d eye = Vector2d::Zero(), ahead = Vector2d::Zero();
  for (double time = 0.0; time < stays; time += 0.1) {
    const Se3 camera = scenario.camera(time);
    eye += camera.translation.head<2>();
    ahead += (camera.rotation * Vector3d::UnitZ()).head<2>();
  }
  eye /= stays / 0.1;
  const Vector2d place = eye + 0.58 * ahead.normalized();
  const Vector2d away(1.90, 0.30);
  FigureOptions options =
      standing(place, -0.5 * pi,
               {stand(-0.5 * pi, stays, Gesture::phone), walk(0.9, -0.3), walk(away),
                stand(pi, 3.0, Gesture::phone), walk(-0.90, 0.10), walk(away), stand(pi, 30.0)});
  options.repeat = false;
  add_person(scenario, seed, 1, options);
}

void moved_furniture(std::uint64_t seed, Scenario& scenario) {
  cv::RNG rng = generator(seed);
  // A cabinet beside the desk; its lowest drawers stay closed.
  const Se3 cabinet = upright({1.45, 2.12}, 0.0);
  add_furniture(scenario, cabinet, drawer_cabinet(rng));
  add_furniture(scenario, cabinet, cabinet_drawer(rng, 0));
  add_furniture(scenario, cabinet, cabinet_drawer(rng, 1));

  // Nobody is in view at first; then somebody pushes a chair, opens the drawer, carries a box away.
  const Vector2d outside(2.0, -1.7), behind_chair(-0.95, 0.65), chair_left(0.50, 0.65);
  const Vector2d before_drawer(1.45, 1.15);
  FigureOptions options =
      standing(outside, 0.5 * pi,
               {stand(0.5 * pi, 5.0), walk(1.90, 0.10), walk(-0.80, 0.20), walk(behind_chair),
                stand(0.0, 1.0, Gesture::carry), walk(chair_left, Gesture::carry),
                stand(0.3, 0.5, Gesture::carry), walk(0.75, 1.20), walk(before_drawer),
                stand(0.5 * pi, 2.2, Gesture::carry), walk(before_box),
                stand(0.5 * pi, 1.6, Gesture::carry), walk(0.55, 0.20, Gesture::carry),
                walk(1.90, 0.0, Gesture::carry), walk(outside, Gesture::carry)});
  options.repeat = false;
  const auto person = add_person(scenario, seed, 1, options);
  const PlaceOverTime places = places_of(options);

  const Stay at_chair = stay_at(places, behind_chair);
  const Stay chair_stays = stay_at(places, chair_left, at_chair.leaves);
  // He walks behind its back: its front is ahead.
  add_thing(scenario, office_chair(rng),
            pushed(person, upright({0.52, 0.0}, 0.5 * pi), at_chair.leaves, chair_stays.arrives),
            "chair");

  const Stay at_drawer = stay_at(places, before_drawer);
  const double opens = at_drawer.arrives + 0.9, closes = at_drawer.leaves + 11.5;
  add_thing(scenario, cabinet_drawer(rng, 2), [=](double time) {
    const double out = 0.36 * (eased(time, opens, opens + 1.1) - eased(time, closes, closes + 0.8));
    return cabinet * upright({0.0, -out}, 0.0);
  });

  const Stay at_box = stay_at(places, before_box);
  const double for_ever = 1e9;
  add_thing(scenario, cardboard_box(rng, box_size),
            carried(person, box_in_hands, {{at_box.leaves - 0.2, for_ever, box_at_rest, {}}}));

  const std::vector<Vector2d> way = {{1.90, 2.85}, {1.90, 0.45}, {-1.10, 0.20}, {-1.25, -1.20}};
  constexpr double speed = 0.85, departure = 0.5, pause = 24.0;
  add_thing(scenario, robot(rng), rolling(way, speed, departure, pause));
}

void lights(std::uint64_t seed, Scenario& scenario) {
  two_walk(seed, scenario);
  scenario.brightness = [](double time) {
    constexpr double every = 6.0, off = 4.0, on = 5.5, fade = 0.08;  // seconds
    const double phase = std::fmod(std::max(time, 0.0), every);
    return 1.0 - eased(phase, off, off + fade) + eased(phase, on, on + fade);
  };
}

void somebody_in_the_flat(std::uint64_t seed, Scenario& scenario) {
  // In the living room; when the camera comes in, he walks past it from the window.
  add_person(scenario, seed, 1,
             standing({5.75, 6.9}, 0.2 * pi,
                      {stand(0.2 * pi, 13.0, Gesture::phone), walk(5.75, 4.35),
                       stand(-0.5 * pi, 4.0, Gesture::point), walk(5.75, 6.9)}));
}

}  // namespace dkp_slam
