#include "viewer/scene.h"

#include <algorithm>
#include <cmath>

#include "viewer/access.h"
#include "viewer/cloud.h"

namespace dkp_slam::viewer {
namespace {

constexpr std::size_t most_frames = 200'000;      // kept, 100 bytes each: two hours at 30 Hz
constexpr std::size_t picture_budget = 64 << 20;  // bytes
constexpr std::size_t cloud_budget = 64 << 20;    // bytes
constexpr std::size_t most_messages = 500;        // kept
constexpr std::ptrdiff_t most_rows = 20'000;      // in one update

float number(double value) { return std::isfinite(value) ? static_cast<float>(value) : 0.0F; }

/// Where a pose stands in a row, see Scene::columns.
constexpr std::size_t pose_column = 5;

std::array<float, 7> numbers_of(const Se3& world_from_camera) {
  const auto& t = world_from_camera.translation;
  const auto& q = world_from_camera.rotation;
  return {number(t.x()), number(t.y()), number(t.z()), number(q.x()),
          number(q.y()), number(q.z()), number(q.w())};
}

}  // namespace

Scene::Scene(SceneInfo info)
    : info_(std::move(info)),
      run_(make_token().substr(0, 12)),
      truth_(info_.truth),
      pictures_(picture_budget),
      frames_(most_frames),
      clouds_(cloud_budget) {}

Scene::Row Scene::row_of(const FrameResult& r, double start) {
  const std::array<float, 7> pose = numbers_of(r.world_from_camera);
  return {number(r.index),
          number(r.timestamp - start),
          r.localised ? 1.0F : 0.0F,
          number(static_cast<int>(r.state)),
          number(r.map),
          pose[0],
          pose[1],
          pose[2],
          pose[3],
          pose[4],
          pose[5],
          pose[6],
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
}

void Scene::add_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  const FrameResult& result = snapshot->result;
  pictures_.offer(snapshot);
  std::shared_ptr<const std::string> cloud;
  if (result.keyframe) {
    cloud = std::make_shared<const std::string>(make_cloud(*snapshot, info_.camera));
  }
  {
    const std::lock_guard lock(mutex_);
    if (!start_) start_ = result.timestamp;
    frames_.add(result.index, row_of(result, *start_));
    if (cloud) next_cloud_ = {result.index, std::move(cloud)};
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::add_keyframe(const KeyframeSnapshot& keyframe) {
  {
    const std::lock_guard lock(mutex_);
    map_.add(keyframe);
    if (next_cloud_.second && next_cloud_.first == keyframe.frame_index) {
      const std::size_t size = next_cloud_.second->size();
      clouds_.add(keyframe.id, std::move(next_cloud_.second), size);
    }
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::apply(const MapChange& change) {
  {
    const std::lock_guard lock(mutex_);
    map_.apply(change);
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::add_message(const std::string& level, const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    const int frame = frames_.entries().empty() ? -1 : frames_.entries().back().frame;
    messages_.push_back({++message_count_, level, text, frame});
    if (messages_.size() > most_messages) messages_.pop_front();
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::finish(const Trajectory& path) {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    ++tick_;
    if (!path.empty() && start_) {
      ++path_version_;
      constexpr float near = 0.002F;  // seconds: rows hold them as float
      auto pose = path.begin();
      for (auto& entry : frames_.entries()) {
        Row& row = entry.value;
        while (pose != path.end() && number(pose->timestamp - *start_) < row[1] - near) ++pose;
        if (pose == path.end()) break;
        if (std::abs(number(pose->timestamp - *start_) - row[1]) > near) continue;
        const std::array<float, 7> placed = numbers_of(pose->world_from_camera);
        std::copy(placed.begin(), placed.end(), row.begin() + pose_column);
      }
    }
  }
  changed_.notify_all();
}

Trajectory Scene::path() const {
  const std::lock_guard lock(mutex_);
  Trajectory path;
  const auto& entries = frames_.entries();
  if (entries.empty()) return path;
  const float map = entries.back().value[4];
  for (const auto& entry : entries) {
    const Row& row = entry.value;
    if (row[2] == 0.0F || row[4] != map) continue;
    StampedPose pose{*start_ + row[1], {}};
    pose.world_from_camera.translation = {row[5], row[6], row[7]};
    path.push_back(pose);
  }
  return path;
}

void Scene::write_frames(const PageState& page, nlohmann::json& head, Container& container) const {
  const auto& entries = frames_.entries();
  const bool reset = page.run != run_ || page.path != path_version_;
  const auto first = frames_.after(reset ? -1 : page.frame);
  const auto last = first + std::min<std::ptrdiff_t>(most_rows, entries.end() - first);
  std::vector<float> rows;
  rows.reserve(columns * static_cast<std::size_t>(last - first));
  for (auto entry = first; entry != last; ++entry)
    rows.insert(rows.end(), entry->value.begin(), entry->value.end());
  container.add("frames", rows);
  head["path"] = path_version_;
  head["path_reset"] = reset;
  head["more"] = last != entries.end();
  head["newest"] = entries.empty() ? -1 : entries.back().frame;
}

std::string Scene::update(const PageState& page, const nlohmann::json& playback) const {
  const std::lock_guard lock(mutex_);
  const bool known = page.run == run_;
  Container container;
  nlohmann::json head = {{"run", run_},
                         {"kind", info_.kind},
                         {"title", info_.title},
                         {"finished", finished_},
                         {"truth", truth_.known()},
                         {"start", start_.value_or(0.0)},
                         {"landmarks", map_.landmarks()},
                         {"playback", playback}};
  write_frames(page, head, container);
  map_.write(known ? page.map : 0, head, container);
  nlohmann::json& messages = head["messages"] = nlohmann::json::array();
  for (const Message& m : messages_) {
    if (known && m.number <= page.message) continue;
    messages.push_back(
        {{"number", m.number}, {"level", m.level}, {"text", m.text}, {"frame", m.frame}});
  }
  nlohmann::json& clouds = head["clouds"] = nlohmann::json::array();
  for (const auto& entry : clouds_.entries()) clouds.push_back(entry.frame);
  if (!known) {
    head["columns"] = columns;
    head["total"] = info_.frames ? nlohmann::json(*info_.frames) : nlohmann::json();
    head["facts"] = info_.facts;
    const Camera& c = info_.camera;
    head["camera"] = {{"width", c.width}, {"height", c.height}, {"fx", c.fx},
                      {"fy", c.fy},       {"cx", c.cx},         {"cy", c.cy}};
  }
  return container.finish(std::move(head));
}

PictureStore::Picture Scene::picture(std::optional<int> frame) {
  return frame ? pictures_.at(*frame) : pictures_.newest();
}

std::shared_ptr<const std::string> Scene::cloud(int keyframe) const {
  const std::lock_guard lock(mutex_);
  const auto* found = clouds_.at(keyframe);
  return found && found->frame == keyframe ? found->value : nullptr;
}

std::shared_ptr<const std::string> Scene::error() {
  if (!truth_.known()) return nullptr;
  return truth_.report([this] { return path(); });
}

std::uint64_t Scene::wait(std::uint64_t tick, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return tick_ != tick; });
  return tick_;
}

void Scene::touch() {
  {
    const std::lock_guard lock(mutex_);
    ++tick_;
  }
  changed_.notify_all();
}

}  // namespace dkp_slam::viewer
