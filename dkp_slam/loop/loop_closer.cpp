#include "dkp_slam/loop/loop_closer.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/localization/relocalizer.h"
#include "dkp_slam/map/id_map.h"
#include "dkp_slam/mapping/later_keyframes.h"

namespace dkp_slam {
namespace {

/// Keyframes that wait to be looked at: where they come faster than that the oldest are left out.
constexpr std::size_t most_waiting = 4;

/// Follows what became of the matches' landmarks since they were found, each once.
void follow(const Map& map, std::vector<FrameMatch>& matches) {
  IdSet taken;
  std::erase_if(matches, [&](FrameMatch& m) {
    m.landmark = map.resolve(m.landmark);
    if (m.landmark < 0 || !taken.insert(m.landmark)) return true;
    m.position = map.landmark(m.landmark).position;
    return false;
  });
}

}  // namespace

LoopCloser::LoopCloser(const LoopCloserOptions& options, std::uint64_t seed, bool realtime)
    : options_(options),
      seed_(seed),
      realtime_(realtime),
      detector_(options.detector),
      aligner_(
          "loop alignment",
          [](Meeting meeting, const std::atomic<bool>&) { return align(std::move(meeting)); },
          realtime),
      solver_(
          "pose graph",
          [weight = options.loop_weight, graph = options.graph](const Problem& problem,
                                                                const std::atomic<bool>& stop) {
            return Solution{problem.graph.solve(problem.loops, weight, graph, &stop),
                            problem.graph.first_later()};
          },
          realtime) {}

void LoopCloser::add_keyframe(int keyframe) {
  if (stage_ != Stage::looking && stage_ != Stage::aligning) return;
  waiting_.push_back(keyframe);
  if (waiting_.size() > most_waiting) waiting_.erase(waiting_.begin() + 1);
}

bool LoopCloser::busy() const { return stage_ != Stage::looking || !waiting_.empty(); }

std::optional<ClosedLoop> LoopCloser::advance(Map& map, const PlaceIndex& places,
                                              const MeasurementModel& model, int frame_index,
                                              bool wait) {
  if (stage_ == Stage::looking) {
    look(map, places, model);
  } else if (stage_ == Stage::aligning) {
    if (realtime_ && !wait && !aligner_.finished()) return std::nullopt;
    if (!accept(map, model, aligner_.take())) try_next_candidate(map, model);
  } else if (stage_ == Stage::gathering) {
    if (graph_->gather(map, options_.gathered_per_frame)) submit(frame_index);
  } else if (stage_ == Stage::fusing && fusion_->advance(map, model, options_.effort_per_frame)) {
    look_again();
    return loop_;
  }
  return std::nullopt;
}

void LoopCloser::look(const Map& map, const PlaceIndex& places, const MeasurementModel& model) {
  if (waiting_.empty()) return;
  if (!detector_.looking()) detector_.look_at(waiting_.front());
  const auto found = detector_.advance(map, places);
  if (!found) return;
  candidates_.assign(found->begin(), found->end());
  try_next_candidate(map, model);
}

void LoopCloser::try_next_candidate(const Map& map, const MeasurementModel& model) {
  const int keyframe = waiting_.front();
  if (map.keyframe(keyframe).removed) candidates_.clear();
  std::erase_if(candidates_, [&](int old) { return map.keyframe(old).removed; });
  if (candidates_.empty()) {
    waiting_.pop_front();
    stage_ = Stage::looking;
    return;
  }
  const int old = candidates_.front();
  candidates_.pop_front();
  loop_ = {keyframe, old};
  aligner_.submit({frame_of(map.keyframe(keyframe)), excerpt_of(map, old), model, seed_});
  stage_ = Stage::aligning;
}

LoopCloser::Alignment LoopCloser::align(Meeting meeting) {
  const Map old(std::move(meeting.old.parts));
  Alignment alignment{std::move(meeting.seen), {}};
  alignment.matches = align_to_keyframe(old, meeting.model, meeting.seed, 0, alignment.seen);
  for (FrameMatch& m : alignment.matches)
    m.landmark = meeting.old.landmarks[static_cast<std::size_t>(m.landmark)];
  return alignment;
}

bool LoopCloser::accept(const Map& map, const MeasurementModel& model, Alignment alignment) {
  const Keyframe &keyframe = map.keyframe(loop_.keyframe), &old = map.keyframe(loop_.old_keyframe);
  if (keyframe.removed || old.removed) return false;
  follow(map, alignment.matches);
  Frame& seen = alignment.seen;
  if (!alignment.matches.empty()) {
    loop_.matches = localize_around(map, model, old.id, std::move(alignment.matches), seen);
  }
  if (loop_.matches < options_.least_matches) {
    spdlog::debug("keyframe {}: no loop to keyframe {}, {} matches", keyframe.id, old.id,
                  loop_.matches);
    return false;
  }
  waiting_.clear();
  candidates_.clear();
  const Se3 off = seen.camera_from_world * keyframe.camera_from_world.inverse();
  keyframe_from_old_ = seen.camera_from_world * old.camera_from_world.inverse();
  seen_ = std::move(seen.landmark);
  loop_.joined_maps = keyframe.map != old.map;
  if (loop_.joined_maps) {
    stage_ = Stage::solving;
    return true;
  }
  loop_.moved = off.translation.norm();
  spdlog::info("keyframe {}: loop to keyframe {} found, {} matches, {:.3f} m and {:.2f} deg off",
               keyframe.id, old.id, loop_.matches, loop_.moved, off.angle() * 180.0 / M_PI);
  graph_.emplace(map, keyframe.map, options_.least_shared);
  stage_ = Stage::gathering;
  return true;
}

void LoopCloser::submit(int frame_index) {
  if (!graph_->has(loop_.keyframe) || !graph_->has(loop_.old_keyframe)) {
    look_again();
    return;
  }
  std::erase_if(loops_,
                [&](const LoopEdge& l) { return !graph_->has(l.from) || !graph_->has(l.to); });
  loops_.push_back({loop_.old_keyframe, loop_.keyframe, keyframe_from_old_});
  due_frame_ =
      frame_index + options_.delay + graph_->keyframes() / options_.keyframes_per_frame_of_delay;
  solver_.submit({std::move(*graph_), loops_});
  graph_.reset();
  stage_ = Stage::solving;
}

bool LoopCloser::due(int frame_index) const {
  if (stage_ != Stage::solving) return false;
  if (loop_.joined_maps) return true;
  return realtime_ ? solver_.finished() : frame_index >= due_frame_;
}

void LoopCloser::carry_out(Map& map) {
  if (loop_.joined_maps) {
    const Keyframe &keyframe = map.keyframe(loop_.keyframe),
                   &old = map.keyframe(loop_.old_keyframe);
    if (keyframe.removed || old.removed || keyframe.map == old.map) {
      look_again();
      return;
    }
    join_map_of(map, loop_.keyframe, loop_.old_keyframe, keyframe_from_old_);
    spdlog::info("keyframe {}: two maps joined at keyframe {}, {} matches", loop_.keyframe,
                 loop_.old_keyframe, loop_.matches);
  } else {
    Solution solution = solver_.take();
    move_with_later_keyframes(map, std::move(solution.move), solution.first_later);
    spdlog::info("keyframe {}: loop to keyframe {} closed", loop_.keyframe, loop_.old_keyframe);
  }
  fusion_.emplace(map, loop_.keyframe, std::move(seen_), options_.fused_neighbours);
  closed_.push_back(loop_);
  stage_ = Stage::fusing;
}

void LoopCloser::look_again() {
  graph_.reset();
  fusion_.reset();
  detector_.reset();
  stage_ = Stage::looking;
}

}  // namespace dkp_slam
