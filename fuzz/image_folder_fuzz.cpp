// Folders in the layouts of ICL-NUIM, 7-Scenes and ScanNet: the names of their files, what they
// hold, and which layout that makes of them.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <unistd.h>
#include <opencv2/imgcodecs.hpp>

#include "dkp_slam/sensor/layout/image_folder.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with the program.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("fuzz_folder." + std::to_string(getpid()))) {}
  ~Folder() { clear(); }

  void clear() const {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  /// Nothing where the name can be none.
  void add(const fs::path& name, const std::string& content) const {
    std::error_code ignored;
    fs::create_directories((path_ / name).parent_path(), ignored);
    std::ofstream(path_ / name, std::ios::binary) << content;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string png_of(const cv::Mat& image) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", image, png);
  return {png.begin(), png.end()};
}

const std::array<const char*, 8> places = {"",      "rgb/",       "depth/",        "color/",
                                           "pose/", "intrinsic/", "frame-000000.", "frame-000001."};

/// Lines "PLACE KIND NAME" say which files there are, KIND 'c' and 'd' with a picture and its
/// depth, or what follows up to an empty line: their text.
void fill(const Folder& folder, const std::string& text) {
  static const std::string colour = png_of(cv::Mat(4, 6, CV_8UC3, cv::Scalar(10, 90, 200))),
                           depth = png_of(cv::Mat(4, 6, CV_16UC1, cv::Scalar(1500)));
  constexpr int most_files = 20;
  std::size_t at = 0;
  for (int i = 0; i < most_files && at + 2 < text.size(); ++i) {
    const std::string place = places[static_cast<unsigned char>(text[at]) % places.size()];
    const char kind = text[at + 1];
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string name = text.substr(at + 2, end > at + 2 ? end - at - 2 : 0);
    std::replace(name.begin(), name.end(), '/', '_');
    std::replace(name.begin(), name.end(), '\0', '_');
    at = std::min(end + 1, text.size());
    std::string content = kind == 'c' ? colour : depth;
    if (kind != 'c' && kind != 'd') {
      const std::size_t last = std::min(text.find("\n\n", at), text.size());
      content = text.substr(at, last - at);
      at = std::min(last + 2, text.size());
    }
    if (!name.empty() && name != "." && name != "..") folder.add(place + name, content);
  }
}

void check_path(const fs::path& folder) {
  double last = -std::numeric_limits<double>::infinity();
  for (const StampedPose& pose : layout_truth(folder, 30.0)) {
    require(pose.timestamp > last, "time stamps that do not rise");
    last = pose.timestamp;
    require(pose.world_from_camera.translation.allFinite(), "a place that is none");
  }
}

void play(const fs::path& folder) {
  Camera camera;
  camera.width = 6;
  camera.height = 4;
  camera.fx = camera.fy = 5.0;
  camera.cx = 2.5;
  camera.cy = 1.5;
  if (const auto own = own_camera(folder)) camera = *own;
  require(!camera.check(), "a camera that was taken is none");
  const auto source = open_image_folder(folder.string(), camera, {}, 30.0);
  constexpr int most_frames = 4;
  for (int i = 0; i < most_frames; ++i) {
    const auto frame = source->read();
    if (!frame) return;
    require(std::isfinite(frame->timestamp), "a time stamp that is no number");
    require(frame->colour.size() == cv::Size(camera.width, camera.height) &&
                frame->depth.size() == frame->colour.size(),
            "an image of another size than the camera's");
  }
}

void run(Bytes bytes) {
  static const Folder folder;
  folder.clear();
  fill(folder, text_of(bytes));
  takes([&] { published_camera(folder.path()); });
  takes([&] { check_path(folder.path()); });
  takes([&] { play(folder.path()); });
}

std::vector<std::string> seeds() {
  const std::string here(1, '\0'), rgb(1, '\1'), depth(1, '\2'), color(1, '\3'), pose(1, '\4'),
      intrinsic(1, '\5'), first(1, '\6');
  const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::string lens = "5 0 2.5 0\n0 5 1.5 0\n0 0 1 0\n0 0 0 1\n\n";
  return {
      rgb + "c0.png\n" + depth + "d0.png\n" + here + "ta.gt.freiburg\n0 0 0 1 0 0 0 1\n\n",
      rgb + "c1.png\n" + depth + "d1.png\n" + here +
          "tassociations.txt\n1 depth/1.png 1 rgb/1.png\n\n" + here +
          "tgroundtruth.txt\n1 0 0 1 0 0 0 1\n\n",
      first + "ccolor.png\n" + first + "ddepth.png\n" + first + "tpose.txt\n" + identity + "\n",
      color + "c0.png\n" + depth + "d0.png\n" + pose + "t0.txt\n" + identity + "\n" + intrinsic +
          "tintrinsic_color.txt\n" + lens + intrinsic + "tintrinsic_depth.txt\n" + lens +
          intrinsic + "textrinsic_color.txt\n" + identity + "\n",
  };
}

const Registration registration({"image_folder", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
