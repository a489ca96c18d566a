#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

/// One movable object of the current frame.
struct DynamicObject {
  int id = 0;                   ///< the same from frame to frame
  int class_id = -1;            ///< as `Detection::class_id`
  cv::Rect2f box;               ///< pixels
  float weight = 10.0F;         ///< W of its class
  bool moves_by_itself = true;  ///< by its class, or seen to move: people, animals
  float score = 0.0F;           ///< of its newest detection
  bool compensated = false;     ///< carried over from earlier frames, not detected in this one
  double last_detected = 0.0;   ///< seconds, time stamp of its newest detection
  float mean_depth = 0.0F;      ///< T, metres, over the mask; 0 when unknown
  float mask_share = 0.0F;      ///< R, mask pixels over box pixels with known depth

  /// A network gave it, so that its box is one person's; of what merely moves there may be several.
  bool named() const { return class_id >= 0; }
};

}  // namespace dkp_slam
