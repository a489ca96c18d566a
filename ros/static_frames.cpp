#include "ros/static_frames.h"

#include <utility>

namespace dkp_slam::ros1 {
namespace {

/// tf's older programs write a slash first.
std::string plain(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace

void StaticFrames::add(const std::string& parent, const std::string& child,
                       const Se3& parent_from_child) {
  const std::lock_guard lock(mutex_);
  links_[plain(child)] = {plain(parent), parent_from_child};
}

StaticFrames::Chain StaticFrames::up_from(std::string frame) const {
  Chain chain;
  Se3 above_from_frame;
  // A circle, which tf does not allow, ends where it began.
  while (chain.emplace(frame, above_from_frame).second) {
    const auto link = links_.find(frame);
    if (link == links_.end()) break;
    above_from_frame = link->second.parent_from_child * above_from_frame;
    frame = link->second.parent;
  }
  return chain;
}

std::optional<Se3> StaticFrames::between(const std::string& parent,
                                         const std::string& child) const {
  const std::lock_guard lock(mutex_);
  const Chain from_parent = up_from(plain(parent)), from_child = up_from(plain(child));
  for (const auto& [frame, common_from_child] : from_child) {
    const auto common = from_parent.find(frame);
    if (common != from_parent.end()) return common->second.inverse() * common_from_child;
  }
  return std::nullopt;
}

}  // namespace dkp_slam::ros1
