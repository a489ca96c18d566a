#include "viewer/frame_rows.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace dkp_slam::viewer {
namespace {

constexpr std::size_t most_frames = 200'000;  // kept, 150 bytes each: two hours at 30 Hz
constexpr std::ptrdiff_t most_rows = 20'000;  // in one update
constexpr std::size_t map_column = 4, pose_column = 5;

float number(double value) { return std::isfinite(value) ? static_cast<float>(value) : 0.0F; }

/// Too little to be seen, and every keyframe does it all the time.
bool is_small(const Se3& motion) {
  constexpr double metres = 0.005, radians = 0.005;
  return motion.translation.norm() < metres && motion.angle() < radians;
}

}  // namespace

FrameRows::FrameRows() : frames_(most_frames) {}

FrameRows::Pose FrameRows::pose_of(const Se3& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  return {number(t.x()), number(t.y()), number(t.z()), number(q.x()),
          number(q.y()), number(q.z()), number(q.w())};
}

Se3 FrameRows::se3_of(const Pose& p) {
  return {Eigen::Quaterniond(p[6], p[3], p[4], p[5]).normalized(), {p[0], p[1], p[2]}};
}

void FrameRows::place(Row& row, const Se3& world_from_camera) {
  const Pose pose = pose_of(world_from_camera);
  std::copy(pose.begin(), pose.end(), row.begin() + pose_column);
}

FrameRows::Row FrameRows::row_of(const FrameResult& r, double start) {
  Row row = {number(r.index),
             number(r.timestamp - start),
             r.localised ? 1.0F : 0.0F,
             number(static_cast<int>(r.state)),
             number(r.map),
             0.0F,
             0.0F,
             0.0F,
             0.0F,
             0.0F,
             0.0F,
             1.0F,
             number(r.features),
             number(r.removed_features),
             number(r.tracked_landmarks),
             number(r.detections),
             number(r.compensated),
             r.keyframe ? 1.0F : 0.0F,
             number(r.decode_ms),
             number(r.feature_ms),
             number(r.detection_ms),
             number(r.clustering_ms),
             number(r.removal_ms),
             number(r.tracking_ms),
             number(r.frame_ms)};
  place(row, r.world_from_camera);
  return row;
}

void FrameRows::add(const FrameResult& result) {
  if (!start_) start_ = result.timestamp;
  Frame frame;
  frame.row = row_of(result, *start_);
  frame.reference = result.localised ? result.reference_keyframe : -1;
  frame.camera_from_reference = pose_of(result.camera_from_reference);
  frames_.add(result.index, frame);
}

void FrameRows::add(const KeyframeSnapshot& keyframe) {
  keyframes_[keyframe.id] = {keyframe.map, keyframe.world_from_camera, keyframe.world_from_camera};
}

std::unordered_map<int, FrameRows::Heir> FrameRows::heirs_of(const MapChange& change) const {
  const std::set<int> gone(change.removed_keyframes.begin(), change.removed_keyframes.end());
  std::unordered_map<int, Heir> heirs;
  for (const int id : gone) {
    const auto old = keyframes_.find(id);
    if (old == keyframes_.end()) continue;
    Heir& heir = heirs[id];
    for (auto before = old; before != keyframes_.begin() && heir.keyframe < 0;) {
      --before;
      if (gone.contains(before->first) || before->second.map != old->second.map) continue;
      heir = {before->first,
              old->second.world_from_keyframe.inverse() * before->second.world_from_keyframe};
    }
  }
  return heirs;
}

std::unordered_map<int, FrameRows::Keyframe> FrameRows::take_moves(const MapChange& change) {
  std::unordered_map<int, Keyframe> moves;
  for (const KeyframeState& k : change.keyframes) {
    const Se3 now = k.camera_from_world.inverse();
    const auto [found, is_new] = keyframes_.try_emplace(k.id, Keyframe{k.map, now, now});
    Keyframe& keyframe = found->second;
    const bool stays = keyframe.map == k.map && is_small(keyframe.placed.inverse() * now);
    keyframe.map = k.map;
    keyframe.world_from_keyframe = now;
    if (is_new || stays) continue;
    keyframe.placed = now;
    moves[k.id] = keyframe;
  }
  return moves;
}

void FrameRows::apply(const MapChange& change) {
  const auto heirs = heirs_of(change);
  for (const int id : change.removed_keyframes) keyframes_.erase(id);
  const auto moves = take_moves(change);
  if (heirs.empty() && moves.empty()) return;
  ++version_;
  for (auto& entry : frames_.entries()) {
    Frame& frame = entry.value;
    if (const auto heir = heirs.find(frame.reference); heir != heirs.end()) {
      frame.reference = heir->second.keyframe;
      frame.camera_from_reference =
          pose_of(se3_of(frame.camera_from_reference) * heir->second.old_from_heir);
    }
    const auto moved = moves.find(frame.reference);
    if (moved == moves.end()) continue;
    frame.row[map_column] = number(moved->second.map);
    place(frame.row,
          moved->second.world_from_keyframe * se3_of(frame.camera_from_reference).inverse());
    frame.version = version_;
  }
}

void FrameRows::finish(const Trajectory& path) {
  if (path.empty() || !start_) return;
  ++version_;
  constexpr float near = 0.002F;  // seconds: rows hold them as float
  auto pose = path.begin();
  for (auto& entry : frames_.entries()) {
    Row& row = entry.value.row;
    while (pose != path.end() && number(pose->timestamp - *start_) < row[1] - near) ++pose;
    if (pose == path.end()) break;
    if (std::abs(number(pose->timestamp - *start_) - row[1]) > near) continue;
    place(row, pose->world_from_camera);
    entry.value.version = version_;
  }
}

Trajectory FrameRows::path() const {
  Trajectory path;
  const auto& entries = frames_.entries();
  if (entries.empty()) return path;
  const float map = entries.back().value.row[map_column];
  for (const auto& entry : entries) {
    const Row& row = entry.value.row;
    if (row[2] == 0.0F || row[map_column] != map) continue;
    StampedPose pose{*start_ + row[1], {}};
    pose.world_from_camera.translation = {row[pose_column], row[pose_column + 1],
                                          row[pose_column + 2]};
    path.push_back(pose);
  }
  return path;
}

int FrameRows::newest() const {
  return frames_.entries().empty() ? -1 : frames_.entries().back().frame;
}

void FrameRows::write(int frame, std::optional<std::uint64_t> version, nlohmann::json& head,
                      Container& container) const {
  const auto& entries = frames_.entries();
  std::vector<float> moved;
  if (version) {
    for (const auto& entry : entries) {
      if (entry.frame > frame || entry.value.version <= *version) continue;
      const Row& row = entry.value.row;
      moved.insert(moved.end(), {row[0], row[map_column]});
      moved.insert(moved.end(), row.begin() + pose_column, row.begin() + pose_column + 7);
    }
  }
  // Where most of it moved it is told anew, in parts.
  const bool reset = !version || moved.size() > moved_columns * most_rows;
  if (reset) moved.clear();
  const auto first = frames_.after(reset ? -1 : frame);
  const auto last = first + std::min<std::ptrdiff_t>(most_rows, entries.end() - first);
  std::vector<float> rows;
  rows.reserve(columns * static_cast<std::size_t>(last - first));
  for (auto entry = first; entry != last; ++entry)
    rows.insert(rows.end(), entry->value.row.begin(), entry->value.row.end());
  container.add("frames", rows);
  container.add("moved", moved);
  head["path"] = version_;
  head["path_reset"] = reset;
  head["more"] = last != entries.end();
  head["newest"] = newest();
}

}  // namespace dkp_slam::viewer
