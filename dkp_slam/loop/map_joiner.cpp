#include "dkp_slam/loop/map_joiner.h"

#include <algorithm>
#include <optional>

#include "dkp_slam/localization/relocalizer.h"
#include "dkp_slam/loop/place_joining.h"

namespace dkp_slam {
namespace {

/// A keyframe found in another map.
struct Meeting {
  int keyframe, old;
  Frame seen;  // the keyframe, localised by `old`
  int matches;
};

std::optional<Meeting> find_elsewhere(const Map& map, const PlaceIndex& places,
                                      const MeasurementModel& model,
                                      const MapJoinerOptions& options, std::uint64_t seed,
                                      int keyframe) {
  const int own = map.keyframe(keyframe).map;
  std::vector<PlaceCandidate> votes = places.votes(map, map.keyframe(keyframe).features.descriptor);
  std::erase_if(votes, [&](const PlaceCandidate& c) {
    return map.keyframe(c.keyframe).map == own || c.votes < options.least_votes;
  });
  for (const PlaceCandidate& c : places.best_groups(map, votes, options.candidates)) {
    Meeting meeting{keyframe, c.keyframe, frame_of(map.keyframe(keyframe)), 0};
    meeting.matches = localize_by_keyframe(map, model, seed, c.keyframe, meeting.seen);
    if (meeting.matches >= options.least_matches) return meeting;
  }
  return std::nullopt;
}

Se3 there_from_here(const Map& map, const Meeting& m) {
  return m.seen.camera_from_world.inverse() * map.keyframe(m.keyframe).camera_from_world;
}

/// Whether one meeting puts the other one's keyframe where that puts it itself.
bool agree(const Map& map, const MapJoinerOptions& options, const Meeting& a, const Meeting& b) {
  if (map.keyframe(a.old).map != map.keyframe(b.old).map) return false;
  const Se3 expected =
      map.keyframe(b.keyframe).camera_from_world * there_from_here(map, a).inverse();
  const Se3 off = b.seen.camera_from_world * expected.inverse();
  return off.translation.norm() < options.translation_bound && off.angle() < options.rotation_bound;
}

/// The meetings that agree with that one which most agree with; empty when these are too few.
std::vector<Meeting> largest_agreement(const Map& map, const MapJoinerOptions& options,
                                       const std::vector<Meeting>& all) {
  std::vector<Meeting> best;
  for (const Meeting& m : all) {
    std::vector<Meeting> with = {m};
    for (const Meeting& other : all) {
      if (other.keyframe != m.keyframe && agree(map, options, m, other)) with.push_back(other);
    }
    if (with.size() > best.size()) best = std::move(with);
  }
  if (static_cast<int>(best.size()) < options.agreeing) best.clear();
  return best;
}

/// Joins the map to another one that it meets, if it does.
std::optional<JoinedMaps> join_one(Map& map, const PlaceIndex& places,
                                   const MeasurementModel& model, const MapJoinerOptions& options,
                                   std::uint64_t seed, int which) {
  std::vector<Meeting> all;
  for (const int k : map.keyframes_in(which)) {
    if (auto meeting = find_elsewhere(map, places, model, options, seed, k))
      all.push_back(std::move(*meeting));
  }
  const std::vector<Meeting> agreeing = largest_agreement(map, options, all);
  if (agreeing.empty()) return std::nullopt;
  const int other = map.keyframe(agreeing.front().old).map;
  const Meeting& best = agreeing.front();
  join_map_of(map, best.keyframe, best.old,
              best.seen.camera_from_world * map.keyframe(best.old).camera_from_world.inverse());
  for (const Meeting& m : agreeing) {
    fuse_seen_again(map, model, m.keyframe, m.seen.landmark, options.fused_neighbours);
  }
  return JoinedMaps{std::min(which, other), std::max(which, other),
                    static_cast<int>(agreeing.size())};
}

}  // namespace

std::vector<JoinedMaps> join_maps(Map& map, const PlaceIndex& places, const MeasurementModel& model,
                                  const MapJoinerOptions& options, std::uint64_t seed) {
  std::vector<JoinedMaps> joined;
  // The youngest first: each is gone once joined, and the older ones grow.
  for (int which = map.maps() - 1; which > 0; --which) {
    if (map.live_keyframes_in(which) == 0) continue;
    if (const auto done = join_one(map, places, model, options, seed, which))
      joined.push_back(*done);
  }
  return joined;
}

}  // namespace dkp_slam
