#include "dkp_slam/synth/scenario.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/synth/people.h"

namespace dkp_slam {
namespace {

constexpr double frame_rate = 30.0;
constexpr std::size_t usual_frames = 600;
constexpr std::size_t frames_of_moved_furniture = 1110;  // until all has moved
constexpr double after_the_loop = 3.0;  // seconds: what was seen first is seen again

struct Recipe {
  ScenarioName name;
  SyntheticMotion motion;
  void (*fill)(std::uint64_t seed, Scenario& scenario);
};

void nobody(std::uint64_t, Scenario&) {}

const std::vector<Recipe>& recipes() {
  using enum SyntheticMotion;
  static const std::vector<Recipe> all = {
      {{"walking_xyz",
        "two people get up, walk about, carry things; the camera moves along its axes"},
       xyz,
       two_walk},
      {{"walking_rpy", "the same; the camera turns about its axes"}, rpy, two_walk},
      {{"walking_halfsphere", "the same; the camera moves around the desk"}, halfsphere, two_walk},
      {{"walking_static", "the same; the camera is held still"}, still, two_walk},
      {{"sitting_static", "two people sit, talk and gesture; the camera is held still"},
       still,
       two_sit},
      {{"sitting_xyz", "the same; the camera moves along its axes"}, slow_xyz, two_sit},
      {{"crowd", "five people walk and sit"}, xyz, crowd},
      {{"close_up", "somebody walks past the camera and stands before it, filling the view"},
       slow_xyz,
       close_up},
      {{"covered_start",
        "somebody fills most of the view from the first frame on; the camera turns"},
       rpy,
       covered_start},
      {{"moved_furniture", "a chair, a drawer, a box and a robot move, with and without people"},
       xyz,
       moved_furniture},
      {{"static_room", "nobody is there"}, xyz, nobody},
      {{"flat_loop",
        "the camera is carried around a flat of several rooms; somebody is on the way"},
       still,
       somebody_in_the_flat},
      {{"lights", "two people walk; the lamps are switched off and on again"}, xyz, lights},
      {{"dropped_frames",
        "two people walk; frames are missing, one by one and up to a second long"},
       xyz,
       two_walk}};
  return all;
}

const Recipe& recipe(const std::string& name) {
  std::string names;
  for (const Recipe& r : recipes()) {
    if (r.name.name == name) return r;
    names += (names.empty() ? "" : ", ") + r.name.name;
  }
  throw Error(fmt::format("no scenario \"{}\"; there are {}", name, names));
}

}  // namespace

const std::vector<ScenarioName>& scenario_names() {
  static const std::vector<ScenarioName> names = [] {
    std::vector<ScenarioName> all;
    for (const Recipe& r : recipes()) all.push_back(r.name);
    return all;
  }();
  return names;
}

Scenario make_scenario(const std::string& name, std::uint64_t seed) {
  const Recipe& found = recipe(name);
  Scenario scenario;
  cv::RNG rng(seed * 1000003 + 5);
  if (name == "flat_loop") {
    scenario.place = flat(rng);
    scenario.camera = walking_motion(flat_loop(), seed);
  } else {
    scenario.place = office(rng);
    scenario.camera = hand_motion(found.motion, seed);
  }
  scenario.drops_frames = name == "dropped_frames";
  found.fill(seed, scenario);
  return scenario;
}

std::size_t default_frames(const std::string& name) {
  recipe(name);
  if (name == "moved_furniture") return frames_of_moved_furniture;
  if (name != "flat_loop") return usual_frames;
  const double seconds = walking_length(flat_loop()) / camera_walking_speed + after_the_loop;
  return static_cast<std::size_t>(seconds * frame_rate);
}

std::vector<std::size_t> arriving_frames(std::size_t count, double rate, std::uint64_t seed) {
  cv::RNG rng(seed * 7919 + 3);
  std::vector<std::size_t> frames;
  double next_burst = rng.uniform(2.0, 4.0), next_single = rng.uniform(1.0, 1.6);
  for (std::size_t i = 0; frames.size() < count; ++i) {
    const double time = static_cast<double>(i) / rate;
    if (time >= next_burst) {
      const double burst = rng.uniform(0.3, 1.0);
      i += static_cast<std::size_t>(burst * rate);
      next_burst = time + burst + rng.uniform(2.5, 5.0);
      next_single = time + burst + rng.uniform(0.2, 1.2);
    } else if (time >= next_single) {
      next_single = time + rng.uniform(0.2, 1.2);
    } else {
      frames.push_back(i);
    }
  }
  return frames;
}

}  // namespace dkp_slam
