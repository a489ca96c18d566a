#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

#include "dkp_slam/system/frame_result.h"
#include "viewer/history.h"

namespace dkp_slam::viewer {

/// A frame's image with what was found in it, as a Container:
///   frame, time (seconds), width, height (of the JPEG), full_width, full_height (of the image)
///   objects: [{id, name, box: [x y w h] in shares of the image, score, carried}]
///   mask: [[x y x y ...]...], outlines, in shares of the image
/// and sections features (uint16: x, y in 65535ths of the image; region | static << 2 | has a
/// landmark << 3) and jpeg. Images wider than `most_width` are made smaller.
std::string encode_picture(const FrameSnapshot& snapshot, int most_width = 640, int quality = 80);

/// The pictures of a run. One is made when somebody asks for it, never before, and kept so that
/// others need not wait and that one can go back to it.
class PictureStore {
 public:
  using Picture = std::shared_ptr<const std::string>;
  /// So that ten pages cost no more pictures than one.
  static constexpr std::chrono::milliseconds least_age{80};

  /// `budget`: bytes; when they are used up, older ones are thinned out.
  explicit PictureStore(std::size_t budget) : kept_(budget) {}

  /// The newest frame, not looked at before somebody asks.
  void offer(std::shared_ptr<const FrameSnapshot> snapshot);
  /// Of the newest frame, or one that was made less than `least_age` ago; null before the first.
  Picture newest();
  /// Of this frame or the last one before it that a picture was made of; null where there is none.
  Picture at(int frame);
  std::size_t pictures() const;

 private:
  std::mutex making_;         // held while a picture is made, so that it is made once
  mutable std::mutex mutex_;  // of what follows
  std::shared_ptr<const FrameSnapshot> offered_;
  std::chrono::steady_clock::time_point made_;  // the last picture
  ThinnedHistory<Picture> kept_;
};

}  // namespace dkp_slam::viewer
