#include "apps/live_path.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "apps/append_line.h"
#include "dkp_slam/error.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;

LivePath::LivePath(fs::path out) : out_(std::move(out)) { remove(); }

LivePath::~LivePath() {
  for (const auto& [map, file] : descriptors_) {
    if (file >= 0) ::close(file);
  }
}

fs::path LivePath::name(std::size_t number) const {
  return out_ /
         (number == 1 ? "trajectory.live.txt" : fmt::format("trajectory_{}.live.txt", number));
}

int LivePath::descriptor_of(int map) {
  const auto known = descriptors_.find(map);
  if (known != descriptors_.end()) return known->second;
  const fs::path file = name(descriptors_.size() + 1);
  const int opened =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  const bool ready =
      opened >= 0 &&
      append_line(opened, "# provisional, of a run under way: timestamp tx ty tz qx qy qz qw\n");
  if (!ready) warn();
  return descriptors_[map] = opened;
}

void LivePath::warn() {
  if (warned_) return;
  warned_ = true;
  spdlog::warn("{}: {}; the run goes on, but a kill would lose its path", name(1).string(),
               std::strerror(errno));
}

void LivePath::on_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  const FrameResult& result = snapshot->result;
  if (!result.localised) return;
  const int file = descriptor_of(result.map);
  if (file < 0) return;
  if (!append_line(file, trajectory_line({result.timestamp, result.world_from_camera}))) warn();
}

void LivePath::remove() {
  std::error_code error;
  for (std::size_t number = 1; fs::remove(name(number), error); ++number) {
  }
}

}  // namespace dkp_slam::apps
