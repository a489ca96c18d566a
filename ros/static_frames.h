#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "dkp_slam/geometry/se3.h"

namespace dkp_slam::ros1 {

/// How a robot's fixed parts lie to one another, as /tf_static tells it: a tree, or several. Each
/// function may be called by any thread.
class StaticFrames {
 public:
  /// `parent_from_child`: metres. The last one told of a child counts.
  void add(const std::string& parent, const std::string& child, const Se3& parent_from_child);
  /// Takes a point of `child` to `parent`; nothing while no chain of transforms joins the two.
  std::optional<Se3> between(const std::string& parent, const std::string& child) const;

 private:
  struct Link {
    std::string parent;
    Se3 parent_from_child;
  };
  using Chain = std::map<std::string, Se3>;

  /// From a frame to each above it: takes a point of the frame to that one.
  Chain up_from(std::string frame) const;

  mutable std::mutex mutex_;
  std::map<std::string, Link> links_;  // by child
};

}  // namespace dkp_slam::ros1
