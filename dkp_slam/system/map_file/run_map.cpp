#include "dkp_slam/system/map_file/run_map.h"

#include <spdlog/spdlog.h>

#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/system/scaled_config.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

/// A file with more is given new ones when a run goes on with it.
constexpr int many_landmark_ids = most_landmark_ids / 10;

}  // namespace

RunMap::RunMap(const fs::path& map, const fs::path& localize, const SlamConfig& config)
    : file_(map) {
  const fs::path& source = localize.empty() ? map : localize;
  if (source.empty()) return;
  if (localize.empty() && !fs::exists(map)) {
    check_writable(map);
    return;
  }
  stored_.emplace(read_map(source));
  check_fits(*stored_, config.camera, config.orb.scale, scaled_to_camera(config).orb.levels);
  spdlog::info("{}: {} keyframes, {} landmarks", source.string(), stored_->map.live_keyframes(),
               stored_->map.live_landmarks());
}

std::optional<Map> RunMap::take_stored() {
  if (!stored_) return std::nullopt;
  Map map = std::move(stored_->map);
  if (file_.empty()) return map;
  writer_ = std::make_unique<MapWriter>(file_, std::move(stored_->state));
  if (map.landmark_ids() >= many_landmark_ids) {
    map = Map(with_new_landmark_ids(parts_of(map)));
    writer_->update(map);
  }
  return map;
}

bool RunMap::begin(const SlamConfig& config) {
  if (file_.empty()) return false;
  if (!writer_) {
    writer_ = std::make_unique<MapWriter>(
        file_, Map(config.camera, config.orb.scale, scaled_to_camera(config).orb.levels));
  }
  return true;
}

void RunMap::on_map(const MapChange& change) {
  if (!warned_ && change.landmark_ids > most_landmark_ids / 2) {
    warned_ = true;
    spdlog::warn("{}: half of all numbers for landmarks are given; another run with it starts anew",
                 file_.string());
  }
  guard([&] { writer_->write(change); });
}

void RunMap::finish() {
  rethrow_failure();
  if (writer_) writer_->finish();
}

}  // namespace dkp_slam
