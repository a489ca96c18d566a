#pragma once

#include <memory>

#include "apps/dense_files.h"
#include "dkp_slam/dense/live/live_dense_map.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam::apps {

/// The static world that is fused while a run lasts, and written when it is over.
class RunDense {
 public:
  /// Throws `Error` for options that make no sense.
  RunDense(const DenseFiles& files, const SlamConfig& config);

  void join(Slam& slam) const;
  const std::shared_ptr<LiveDenseMap>& map() const { return dense_; }
  /// After Slam::finish. Throws `Error` where there is nothing to write or it cannot be written.
  void write() const;

 private:
  DenseFiles files_;
  const std::shared_ptr<LiveDenseMap> dense_;
};

}  // namespace dkp_slam::apps
