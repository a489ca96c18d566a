// The place index against brute force over all landmarks.
#include "dkp_slam/localization/place_index.h"

#include <map>

#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

/// A few descriptors far apart, and bits of one turned.
Descriptor look(Reader& input) {
  Descriptor d{};
  const std::uint64_t kind = input.take<std::uint8_t>() % 5;
  for (std::uint64_t& word : d) word = kind * 0x9E3779B97F4A7C15ULL;
  for (int bits = input.below(80); bits > 0; --bits) {
    const unsigned bit = input.take<std::uint8_t>();
    d[bit / 64] ^= 1ULL << (bit % 64);
  }
  return d;
}

int add_keyframe(Map& map, Reader& input) {
  Keyframe k;
  const std::vector<int> known = map.landmarks();
  for (int seen = input.below(4); seen > 0 && !known.empty(); --seen) {
    const int l = known[input.take<std::uint8_t>() % known.size()];
    if (std::find(k.landmarks.begin(), k.landmarks.end(), l) != k.landmarks.end()) continue;
    k.landmarks.push_back(l);
    k.features.descriptor.push_back(map.landmark(l).descriptor);
  }
  const std::size_t old = k.landmarks.size();
  for (int made = input.below(5); made > 0; --made) {
    k.landmarks.push_back(-1);
    k.features.descriptor.push_back(look(input));
  }
  const std::size_t features = k.landmarks.size();
  k.features.pixel.resize(features);
  k.features.level.resize(features);
  const int id = map.add_keyframe(std::move(k));
  for (std::size_t f = old; f < features; ++f)
    map.add_landmark({0.0, 0.0, 1.0}, id, static_cast<int>(f));
  map.update_covisibility(id);
  return id;
}

/// Per keyframe, features of the frame that some landmark it sees is at most so many bits from.
std::map<int, int> votes_within(const Map& map, const std::vector<Descriptor>& frame, int bits) {
  std::map<int, int> votes;
  for (const Descriptor& feature : frame) {
    std::map<int, bool> voted;
    for (const int l : map.landmarks()) {
      if (hamming_distance(map.landmark(l).descriptor, feature) > bits) continue;
      for (const Sighting& s : map.landmark(l).sightings) voted[s.keyframe] = true;
    }
    for (const auto& [keyframe, yes] : voted) ++votes[keyframe];
  }
  return votes;
}

void run(Bytes bytes) {
  Reader input(bytes);
  PlaceIndexOptions options;
  options.tables = 2;  // as many as are quickly made anew for each input
  PlaceIndex places(options);
  Map map(Camera{}, 1.2F, 8);
  for (int steps = input.below(12); steps > 0 && !input.empty(); --steps) {
    if (input.below(4) > 0 || map.landmarks().empty()) {
      places.add_keyframe(map, add_keyframe(map, input));
    } else {
      const std::vector<int> all = map.landmarks();
      map.remove_landmark(all[input.take<std::uint8_t>() % all.size()]);
    }
  }
  std::vector<Descriptor> frame;
  while (!input.empty() && frame.size() < 20) frame.push_back(look(input));

  // Of two keys, one is right where one bit at most is wrong; nothing beyond the bound may vote.
  const std::map<int, int> least = votes_within(map, frame, 1);
  const std::map<int, int> most = votes_within(map, frame, options.match_bits);
  std::map<int, int> found;
  for (const PlaceCandidate& c : places.votes(map, frame)) found[c.keyframe] = c.votes;
  for (const auto& [keyframe, votes] : least) {
    require(found[keyframe] >= votes, "a landmark that looks like the feature has no vote");
  }
  for (const auto& [keyframe, votes] : found) {
    const auto bound = most.find(keyframe);
    require(votes <= (bound == most.end() ? 0 : bound->second),
            "a landmark votes that looks unlike");
  }
  for (const PlaceCandidate& c : places.query(map, frame, 5)) {
    require(found.contains(c.keyframe), "a candidate without a vote");
  }
}

std::vector<std::string> seeds() {
  std::string one{'\10'};
  for (int i = 0; i < 300; ++i) one += static_cast<char>(i * 53 % 241);
  std::string same{'\3'};
  for (int i = 0; i < 40; ++i) same += std::string("\1\0\4\0\0\0\0", 7);
  return {one, same};
}

const Registration registration({"place_index", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
