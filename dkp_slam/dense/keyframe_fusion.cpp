#include "dkp_slam/dense/keyframe_fusion.h"

#include <algorithm>
#include <numeric>

namespace dkp_slam {
namespace {

constexpr double share_of_free = 0.25;  // of the voxels' memory
constexpr std::size_t few = 4;          // one part in so many keyframes

}  // namespace

KeyframeFusion::KeyframeFusion(const Camera& camera, const KeyframeFusionOptions& options)
    : options_(options), viewer_(camera, options.view) {
  begin_anew();
}

void KeyframeFusion::begin_anew() {
  fused_.clear();
  map_.reset();  // before there is another
  map_ = std::make_unique<DenseMap>(viewer_.camera(), options_.map);
  free_.reset();
  if (options_.cell > 0.0) {
    free_ = std::make_unique<FreeSpace>(viewer_.camera(), options_.cell,
                                        share_of_free * options_.map.memory);
  }
}

bool KeyframeFusion::has_moved(const Se3& from, const Se3& to) const {
  const double seen_at = 0.5 * options_.view.max_range;
  const double turned = from.rotation.angularDistance(to.rotation);
  const double moved = (from.translation - to.translation).norm() + turned * seen_at;
  return moved > options_.moved * options_.map.voxel;
}

KeyframeFusion::Plan KeyframeFusion::plan(std::span<const PosedImage> keyframes) const {
  Plan plan;
  auto old = fused_.begin();
  for (const PosedImage& k : keyframes) {
    for (; old != fused_.end() && old->first < k.id; ++old) plan.out.push_back(old->first);
    const bool known = old != fused_.end() && old->first == k.id;
    if (known && !has_moved(old->second.world_from_camera, k.world_from_camera)) {
      ++old;
      continue;
    }
    if (known) plan.out.push_back((old++)->first);
    plan.in.push_back(&k);
    plan.appended += !known && old == fused_.end();
  }
  for (; old != fused_.end(); ++old) plan.out.push_back(old->first);
  return plan;
}

StaticView KeyframeFusion::view_of(const PosedImage& keyframe) const {
  const KeyframeImage& image = *keyframe.image;
  // Depth was taken a little before or after colour.
  const Se3 moved = Se3::exp(image.velocity * image.depth_delay);
  return viewer_.view(frame_of(image), keyframe.world_from_camera * moved, image.velocity);
}

std::vector<std::size_t> KeyframeFusion::all_blocks() const {
  std::vector<std::size_t> blocks(map_->voxels().size());
  std::iota(blocks.begin(), blocks.end(), std::size_t{0});
  return blocks;
}

std::vector<std::size_t> KeyframeFusion::make_room(const Plan& plan) {
  const double margin = map_->options().truncation;
  const std::size_t before = map_->voxels().size();
  const std::vector<std::size_t> old_blocks = all_blocks();
  std::vector<bool> stale(before, false);
  const auto spoil = [&](const PosedImage& k) {
    for (const std::size_t b : map_->in_view(k.world_from_camera, k.image->farthest, old_blocks)) {
      stale[b] = true;
    }
  };
  for (const int id : plan.out) {
    const PosedImage& k = fused_.at(id);
    spoil(k);
    if (free_) free_->remove(view_of(k), margin);
    fused_.erase(id);
  }
  for (std::size_t i = 0; i < plan.in.size(); ++i) {
    const PosedImage& k = *plan.in[i];
    const StaticView view = view_of(k);
    // One behind all others is fused after them, on top of what there is.
    if (i + plan.appended < plan.in.size()) spoil(k);
    map_->reserve(view);
    if (free_) free_->add(view, margin);
    fused_.emplace(k.id, k);
  }
  std::vector<std::size_t> blocks;
  for (std::size_t b = 0; b < map_->voxels().size(); ++b) {
    if (b < before && !stale[b]) continue;
    if (b < before) map_->clear(b);
    blocks.push_back(b);
  }
  return blocks;
}

bool KeyframeFusion::update(std::span<const PosedImage> keyframes, const std::atomic<bool>* stop) {
  Plan todo = plan(keyframes);
  const std::size_t moved = todo.out.size() + todo.in.size() - todo.appended;
  if (few * todo.out.size() > fused_.size() || (moved > 0 && map_->full())) {
    fused_again_ += static_cast<long>(fused_.size());
    begin_anew();
    todo = plan(keyframes);
  } else {
    fused_again_ += static_cast<long>(todo.out.size());
  }
  if (todo.out.empty() && todo.in.empty()) return true;
  const int first_appended =
      todo.appended > 0 ? todo.in[todo.in.size() - todo.appended]->id : keyframes.back().id + 1;
  const std::vector<std::size_t> stale = make_room(todo);
  const std::vector<std::size_t> all = all_blocks();
  for (const auto& [id, k] : fused_) {
    if (stop && *stop) return false;
    const bool appended = id >= first_appended;
    const std::vector<std::size_t> blocks =
        map_->in_view(k.world_from_camera, k.image->farthest, appended ? all : stale);
    if (!blocks.empty()) map_->fuse(view_of(k), blocks);
  }
  return true;
}

Trajectory KeyframeFusion::path() const {
  Trajectory path;
  for (const auto& [id, k] : fused_) path.push_back({k.image->timestamp, k.world_from_camera});
  return path;
}

}  // namespace dkp_slam
