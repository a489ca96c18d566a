#include "viewer/scene.h"

#include "viewer/access.h"
#include "viewer/cloud.h"

namespace dkp_slam::viewer {
namespace {

constexpr std::size_t picture_budget = 64 << 20;  // bytes
constexpr std::size_t cloud_budget = 64 << 20;    // bytes
constexpr std::size_t most_messages = 500;        // kept

}  // namespace

Scene::Scene(SceneInfo info)
    : info_(std::move(info)),
      run_(make_token().substr(0, 12)),
      truth_(info_.truth),
      pictures_(picture_budget),
      clouds_(cloud_budget) {}

void Scene::add_frame(const std::shared_ptr<const FrameSnapshot>& snapshot) {
  const FrameResult& result = snapshot->result;
  pictures_.offer(snapshot);
  std::shared_ptr<const std::string> cloud;
  if (result.keyframe) {
    cloud = std::make_shared<const std::string>(make_cloud(*snapshot, info_.camera));
  }
  {
    const std::lock_guard lock(mutex_);
    frames_.add(result);
    if (cloud) next_cloud_ = {result.index, std::move(cloud)};
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::add_keyframe(const KeyframeSnapshot& keyframe) {
  {
    const std::lock_guard lock(mutex_);
    map_.add(keyframe);
    frames_.add(keyframe);
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
    frames_.apply(change);
    ++tick_;
  }
  changed_.notify_all();
}

void Scene::add_message(const std::string& level, const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    messages_.push_back({++message_count_, level, text, frames_.newest()});
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
    frames_.finish(path);
  }
  changed_.notify_all();
}

Trajectory Scene::path() const {
  const std::lock_guard lock(mutex_);
  return frames_.path();
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
                         {"start", frames_.start()},
                         {"landmarks", map_.landmarks()},
                         {"fused", fused_ ? nlohmann::json(fused_->version()) : nlohmann::json()},
                         {"playback", playback}};
  frames_.write(page.frame, known ? std::optional(page.path) : std::nullopt, head, container);
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
    head["columns"] = FrameRows::columns;
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

void Scene::show(std::shared_ptr<FusedCloud> fused) {
  const std::lock_guard lock(mutex_);
  fused_ = std::move(fused);
}

std::shared_ptr<const std::string> Scene::fused_cloud(int map) const {
  std::shared_ptr<FusedCloud> fused;
  {
    const std::lock_guard lock(mutex_);
    fused = fused_;
  }
  // It takes its time, in which the run goes on.
  return fused ? fused->cloud(map) : nullptr;
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
