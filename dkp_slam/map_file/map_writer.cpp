#include "dkp_slam/map_file/map_writer.h"

#include <utility>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/map_rows.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

MapFileState state_of_new(const fs::path& file, const Map& map) {
  create_map_file(file, map);
  return {};
}

}  // namespace

MapWriter::MapWriter(const fs::path& file, const Map& map, const MapWriterOptions& options)
    : MapWriter(file, state_of_new(file, map), options) {}

MapWriter::MapWriter(const fs::path& file, MapFileState state, const MapWriterOptions& options)
    : options_(options), state_(std::move(state)) {
  check_map_header(file);
  database_ = std::make_unique<sqlite::Database>(file, sqlite::Access::exclusive);
  if (map_revision(*database_) != state_.revision) {
    throw Error(
        fmt::format("{}: another process has changed it meanwhile; start again", file.string()));
  }
  thread_ = std::thread(&MapWriter::work, this);
}

MapWriter::~MapWriter() { stop(); }

bool MapWriter::due() const {
  if (updated_ && Clock::now() - *updated_ < options_.interval) return false;
  const std::scoped_lock lock(mutex_);
  return !busy_ || !failure_.empty();
}

void MapWriter::throw_failure() const {
  const std::scoped_lock lock(mutex_);
  if (!failure_.empty()) throw Error(failure_);
}

void MapWriter::update(const Map& map) {
  throw_failure();
  updated_ = Clock::now();
  {
    const std::scoped_lock lock(mutex_);
    if (busy_) return;
  }
  hand_over(map);
}

void MapWriter::hand_over(const Map& map) {
  MapChange change = state_.finder.find(map);
  if (change.empty()) return;
  {
    const std::scoped_lock lock(mutex_);
    change_ = std::move(change);
    busy_ = true;
  }
  changed_.notify_all();
}

void MapWriter::finish(const Map& map) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !busy_ || !failure_.empty(); });
  }
  throw_failure();
  hand_over(map);
  stop();
  throw_failure();
  database_->checkpoint();
  database_.reset();
}

void MapWriter::stop() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MapWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return busy_ || closing_; });
    if (!busy_) return;
    std::string failure;
    {
      const MapChange change = std::exchange(change_, {});
      lock.unlock();
      try {
        write_change(*database_, change);
      } catch (const std::exception& error) {
        failure = error.what();
      }
    }  // a large change takes its time to be freed, too
    lock.lock();
    busy_ = false;
    failure_ = failure;
    changed_.notify_all();
    if (!failure_.empty()) return;
  }
}

}  // namespace dkp_slam
