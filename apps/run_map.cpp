#include "apps/run_map.h"

#include <spdlog/spdlog.h>

#include "dkp_slam/export/atomic_file.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;

RunMap::RunMap(const fs::path& map, const fs::path& localize, const SlamConfig& options)
    : file_(map) {
  const fs::path& source = localize.empty() ? map : localize;
  if (source.empty()) return;
  if (localize.empty() && !fs::exists(map)) {
    check_writable(map);
    return;
  }
  stored_.emplace(read_map(source));
  check_fits(*stored_, options.camera, options.orb.scale, options.orb.levels);
  spdlog::info("{}: {} keyframes, {} landmarks", source.string(), stored_->map.live_keyframes(),
               stored_->map.live_landmarks());
}

std::optional<Map> RunMap::take_stored() {
  if (!stored_) return std::nullopt;
  return std::move(stored_->map);
}

void RunMap::begin(const Map& map) {
  if (file_.empty()) return;
  writer_ = stored_ ? std::make_unique<MapWriter>(file_, std::move(stored_->state))
                    : std::make_unique<MapWriter>(file_, map);
}

void RunMap::update(const Map& map) {
  if (writer_ && writer_->due()) writer_->update(map);
}

void RunMap::finish(const Map& map) {
  if (writer_) writer_->finish(map);
}

}  // namespace dkp_slam::apps
