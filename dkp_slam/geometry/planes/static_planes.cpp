#include "dkp_slam/geometry/planes/static_planes.h"

#include <algorithm>
#include <cmath>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {
namespace {

/// Within `turn` radians and `shift` metres of each other, at the place nearest to the camera.
bool alike(const Plane& a, const Plane& b, double turn, double shift) {
  const auto cosine = static_cast<double>(a.normal.dot(b.normal));
  const float side = cosine < 0.0 ? -1.0F : 1.0F;
  return std::abs(cosine) > std::cos(turn) &&
         static_cast<double>(std::abs(a.distance - side * b.distance)) < shift;
}

}  // namespace

void StaticPlanesOptions::describe(OptionList& list) {
  list.add("memory", memory, at_least(0), "seconds",
           "that a plane is remembered after it was last found");
  list.add("proof", proof, at_least(0), "seconds",
           "over which a plane must have been found to be remembered");
  list.add("large_proof", large_proof, at_least(0), "seconds", "the same, of a large plane");
  list.add("large_extent", large_extent, at_least(0), "metres", "of a large plane");
  list.add("large_width", large_width, at_least(0), "metres", "of a large plane, across");
  list.add("min_support", min_support, between(0, 1), "",
           "of the view's depth on a plane that stays");
  list.add("most_turn", most_turn, at_least(0), "radians", "by which a plane is fitted anew");
  list.add("most_shift", most_shift, at_least(0), "metres", "by which a plane is fitted anew");
  list.add("same_turn", same_turn, at_least(0), "radians", "between two planes that are one");
  list.add("same_shift", same_shift, at_least(0), "metres", "between two planes that are one");
}

void StaticPlanesOptions::check() const { check_options(*this); }

bool StaticPlanes::runs_through_people(const DepthView& view, const cv::Mat& silhouettes,
                                       const cv::Mat& people, const Plane& plane) const {
  int inside = 0, outside = 0, on_them = 0;
  constexpr int stride = 6;  // about 2,000 points of a 640x480 image
  for (int y = stride / 2; y < view.depth.rows; y += stride) {
    for (int x = stride / 2; x < view.depth.cols; x += stride) {
      if (!runs_along(view, plane, x, y, plane_options_)) continue;
      (people.at<std::uint8_t>(y, x) != 0 ? inside : outside) += 1;
      on_them += silhouettes.at<std::uint8_t>(y, x) != 0 ? 1 : 0;
    }
  }
  // Where people fill the view their hulls hold most of the room, too: then it ends at them.
  constexpr double most_on_them = 0.1;
  return inside > outside && on_them > most_on_them * (inside + outside);
}

void StaticPlanes::look(const DepthView& view, const cv::Mat& hidden, const cv::Mat& people,
                        double time, std::uint64_t seed) {
  std::vector<Plane> found = fit_planes(view, hidden, plane_options_, seed);
  const bool none_known = none_proved();
  if (!people.empty()) {
    std::erase_if(found, [&](const Plane& p) {
      // Silhouettes of a start may hold the desk they stand at.
      if (none_known && is_large_enough(p, larger_than_people(plane_options_))) return false;
      return runs_through_people(view, hidden, people, p);
    });
  } else if (!hidden.empty() && none_known) {
    add_largest(view, seed, found);
  }
  update(view, found, time);
}

/// The box of somebody close hides whatever he stands at: what is larger than he is tells. The
/// largest of all the view: the next one may be two backs.
void StaticPlanes::add_largest(const DepthView& view, std::uint64_t seed,
                               std::vector<Plane>& found) const {
  PlaneOptions largest = larger_than_people(plane_options_);
  largest.max_planes = std::min(largest.max_planes, 1);
  largest.iterations *= 5;  // masks of the next frames depend on it
  for (const Plane& p : fit_planes(view, {}, largest, seed)) {
    if (!is_among(found, p)) found.push_back(p);
  }
}

void StaticPlanes::move(const Se3& current_from_previous) {
  const Eigen::Matrix3f rotation = current_from_previous.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = current_from_previous.translation.cast<float>();
  for (Known& k : known_) {
    k.plane.normal = rotation * k.plane.normal;
    k.plane.distance += k.plane.normal.dot(translation);
  }
}

bool StaticPlanes::is_proved(const Known& known) const {
  const double needed = known.large ? options_.large_proof : options_.proof;
  return known.last_found - known.first_found >= needed;
}

bool StaticPlanes::none_proved() const {
  return std::none_of(known_.begin(), known_.end(), [&](const Known& k) { return is_proved(k); });
}

std::vector<Plane> StaticPlanes::planes() const {
  std::vector<Plane> out;
  for (const Known& k : known_) {
    if (is_proved(k) || k.last_found >= time_) out.push_back(k.plane);
  }
  return out;
}

std::vector<Plane> StaticPlanes::surest() const {
  std::vector<Plane> out;
  for (const Known& k : known_) {
    if (is_proved(k)) out.push_back(k.plane);
  }
  return out.empty() ? planes() : out;
}

bool StaticPlanes::adapt(const DepthView& view, Plane& plane) const {
  std::vector<Eigen::Vector3f> on;
  int known = 0;
  constexpr int stride = 6;  // about 2,000 points of a 640x480 image
  for (int y = stride / 2; y < view.depth.rows; y += stride) {
    for (int x = stride / 2; x < view.depth.cols; x += stride) {
      known += view.depth.at<float>(y, x) > 0.0F;
      if (runs_along(view, plane, x, y, plane_options_)) on.push_back(view.point(x, y));
    }
  }
  if (static_cast<double>(on.size()) < options_.min_support * known) return false;
  constexpr std::size_t least = 30;  // points: fewer do not fix a plane's slope
  if (on.size() < least) return !on.empty();
  const Plane fitted = fit_plane(on);
  if (alike(fitted, plane, options_.most_turn, options_.most_shift)) plane = fitted;
  return true;
}

bool StaticPlanes::is_same(const Plane& a, const Plane& b) const {
  return alike(a, b, options_.same_turn, options_.same_shift);
}

bool StaticPlanes::is_among(const std::vector<Plane>& planes, const Plane& plane) const {
  return std::any_of(planes.begin(), planes.end(),
                     [&](const Plane& other) { return is_same(other, plane); });
}

bool StaticPlanes::is_large(const Plane& plane) const {
  return static_cast<double>(plane.extent) >= options_.large_extent &&
         static_cast<double>(plane.width) >= options_.large_width;
}

void StaticPlanes::update(const DepthView& view, const std::vector<Plane>& found, double time) {
  time_ = time;
  std::vector<Known> now;
  for (const Plane& p : found) {
    Known fresh{p, time, time, is_large(p)};
    for (const Known& k : known_) {
      if (!is_same(k.plane, p)) continue;
      fresh.first_found = std::min(fresh.first_found, k.first_found);
      fresh.large = fresh.large || k.large;
    }
    now.push_back(fresh);
  }
  for (Known& k : known_) {
    if (!is_among(found, k.plane) && time - k.last_found <= options_.memory && adapt(view, k.plane))
      now.push_back(k);
  }
  known_ = std::move(now);
}

}  // namespace dkp_slam
