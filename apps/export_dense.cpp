#include "apps/export_dense.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/camera_choice.h"
#include "apps/frame_rate_option.h"
#include "apps/progress.h"
#include "apps/run_masks.h"
#include "apps/run_summary.h"
#include "apps/source_choice.h"
#include "dkp_slam/error.h"
#include "dkp_slam/sensor/kinect/kinect_source.h"
#include "dkp_slam/sensor/mask_folder.h"

namespace dkp_slam::apps {
namespace fs = std::filesystem;
namespace {

constexpr double same_time = 2e-6;  // seconds: trajectories have microseconds
/// Seconds between poses of which a velocity is told.
constexpr double longest_step = 0.2;

/// A frame at a pose that is known.
using UseView = std::function<void(const StaticView&)>;

/// Where the images are, and what moves in them.
struct Images {
  SourceChoice source;
  std::string camera;  ///< that the run had; empty where it says nothing
  fs::path masks;      ///< empty: all pixels are static
  bool masks_by_time = false;
};

/// The masks of the run, or what the user gave. Nobody is to fuse people without saying so.
void choose_masks(const DenseExport& dense, const fs::path& run, Images& images) {
  if (dense.no_masks) return;
  images.masks = dense.masks;
  if (!images.masks.empty()) return;
  images.masks = run / masks_folder;
  images.masks_by_time = true;
  if (!run.empty() && fs::is_directory(images.masks)) return;
  throw Error(fmt::format(
      "{}: no masks of what moves; run again with --save-masks, give --masks DIR, or --no-masks to "
      "fuse everything, people too",
      run.empty() ? "the trajectory" : images.masks.string()));
}

/// What the run was made of, unless the user says.
void choose_source(const DenseExport& dense, const fs::path& run, Images& images) {
  SourceChoice& choice = images.source;
  choice.camera = dense.camera;
  choice.topics = dense.topics;
  choice.frame_rate = dense.frame_rate;
  choice.name = dense.sequence.string();
  if (!choice.name.empty()) return;
  if (run.empty()) return;
  const RunInput input = read_run_input(run);
  choice.name = input.sequence;
  if (choice.topics.empty()) choice.topics = input.topics;
  if (input.frame_rate) choice.frame_rate = *input.frame_rate;
  if (!choice.camera.empty()) return;
  images.camera = input.camera;
  // One that is no file came with the images, and should do so again.
  if (fs::is_regular_file(images.camera)) choice.camera = images.camera;
}

Images choose_images(const DenseExport& dense, const fs::path& run) {
  Images images;
  choose_source(dense, run, images);
  const std::string& name = images.source.name;
  if (name.empty()) {
    throw Error("the dense map needs the images: give the folder of the sequence with --sequence");
  }
  if (is_stream(name) || is_kinect(name)) {
    throw Error(name +
                ": cannot be read again; what `dkp-slam record` kept of it can be given with "
                "--sequence");
  }
  if (!fs::exists(name)) {
    throw Error(name + ": no such folder or bag; give that of the sequence with --sequence");
  }
  choose_masks(dense, run, images);
  if (!images.masks_by_time) images.source.masks = images.masks;
  if (!images.source.masks.empty() && is_bag_file(name)) {
    throw Error(name +
                ": --masks needs images with names, which a bag's have not; `dkp-slam "
                "record` makes a folder of it");
  }
  return images;
}

/// What is farther away than any building has numbers that voxels do not.
void check_extent(const Trajectory& path) {
  constexpr double farthest = 10'000.0;  // metres
  for (const StampedPose& pose : path) {
    if (pose.world_from_camera.translation.norm() < farthest) continue;
    throw Error(
        fmt::format("the pose at {:.6f} s lies more than {:g} m from the world's origin; "
                    "is the trajectory in metres?",
                    pose.timestamp, farthest));
  }
}

/// Tangent per second of the camera's motion around a pose of the path.
Vector6d velocity_at(const Trajectory& path, std::size_t i) {
  const std::size_t a = i > 0 ? i - 1 : i, b = std::min(i + 1, path.size() - 1);
  const double time = path[b].timestamp - path[a].timestamp;
  if (!(time > 0.0) || time > 2.0 * longest_step) return Vector6d::Zero();
  return (path[a].world_from_camera.inverse() * path[b].world_from_camera).log() / time;
}

/// Plays the images of a sequence at their poses, as often as it is asked.
class PosedImages {
 public:
  PosedImages(const DenseExport& dense, Images images, const Trajectory& path)
      : images_(std::move(images)),
        path_(path),
        every_(static_cast<std::size_t>(dense.every)),
        opened_(open_source(images_.source)),
        viewer_(opened_.camera, dense.view) {
    if (!images_.camera.empty() && images_.camera != opened_.camera_name) {
      throw Error(images_.camera +
                  ": this camera of the run is not there any more; give one with "
                  "--camera");
    }
  }

  /// Views that were used.
  std::size_t play(const std::string& label, const UseView& use) {
    // The first time it is open already.
    const std::unique_ptr<RgbdSource> source =
        opened_.source ? std::move(opened_.source) : open_source(images_.source).source;
    const std::unique_ptr<MaskFolder> masks = open_masks();
    Progress progress(label, source->size());
    std::size_t used = 0, posed = 0, unmasked = 0;
    while (auto frame = source->read()) {
      if (interrupted()) throw Error("interrupted; nothing of the static world was written");
      progress.update(static_cast<std::size_t>(frame->index) + 1);
      const auto pose = pose_at(frame->timestamp);
      if (!pose || posed++ % every_ != 0) continue;
      if (masks) frame->mask = masks->read(mask_name(frame->timestamp), frame->colour.size());
      if (!images_.masks.empty() && frame->mask.empty()) {
        ++unmasked;
        continue;
      }
      const Vector6d velocity = velocity_at(path_, *pose);
      // Depth was taken a little before or after colour.
      const Se3 moved = Se3::exp(velocity * frame->depth_delay);
      use(viewer_.view(*frame, path_[*pose].world_from_camera * moved, velocity));
      ++used;
    }
    check(used, posed, unmasked);
    unmasked_ = unmasked;
    return used;
  }

  const Camera& camera() const { return opened_.camera; }
  std::size_t unmasked() const { return unmasked_; }

 private:
  /// Null for those that come with the images.
  std::unique_ptr<MaskFolder> open_masks() const {
    if (!images_.masks_by_time) return nullptr;
    std::vector<std::string> names;
    for (const StampedPose& pose : path_) names.push_back(mask_name(pose.timestamp));
    return std::make_unique<MaskFolder>(images_.masks, names);
  }

  std::optional<std::size_t> pose_at(double time) const {
    const auto found =
        std::lower_bound(path_.begin(), path_.end(), time - same_time,
                         [](const StampedPose& pose, double t) { return pose.timestamp < t; });
    if (found == path_.end() || found->timestamp > time + same_time) return std::nullopt;
    return static_cast<std::size_t>(found - path_.begin());
  }

  void check(std::size_t used, std::size_t posed, std::size_t unmasked) const {
    if (used > 0) return;
    if (posed == 0) {
      throw Error(images_.source.name +
                  ": none of its images has the time stamp of a pose; is it the sequence of this "
                  "run?");
    }
    throw Error(fmt::format("{}: holds no mask for any of {} images that have a pose",
                            images_.masks.string(), unmasked));
  }

  Images images_;
  const Trajectory& path_;
  std::size_t every_;
  OpenedSource opened_;
  DepthViewer viewer_;
  std::size_t unmasked_ = 0;
};

}  // namespace

void export_dense(const DenseExport& dense, const fs::path& run, const Trajectory& path) {
  catch_interrupts();
  check_extent(path);
  PosedImages images(dense, choose_images(dense, run), path);
  const Camera& camera = images.camera();
  DenseMap map(camera, dense.map);
  std::unique_ptr<FreeSpace> free;
  if (dense.needs_free_space()) {
    constexpr double share_of_free = 0.25;
    free = std::make_unique<FreeSpace>(camera, dense.band.cell, share_of_free * dense.map.memory);
  }
  images.play("export: room", [&](const StaticView& view) { map.reserve(view); });
  const std::size_t used = images.play("export: fuse", [&](const StaticView& view) {
    map.fuse(view);
    if (free) free->add(view, map.options().truncation);
  });
  if (images.unmasked() > 0) {
    spdlog::warn("{} images without a mask were left out", images.unmasked());
  }
  write_dense_files(dense, map, free.get(), path, used);
}

void add_dense_options(CLI::App& command, DenseExport& dense) {
  add_dense_file_options(command, dense);
  const std::string group = "Static world";
  const auto add = [&](const std::string& name, auto& variable, const std::string& help) {
    return command.add_option(name, variable, help)->group(group);
  };
  add("--sequence", dense.sequence,
      "Folder or bag of the images; default: the one that the run was made of");
  add("--topics", dense.topics, "Of a bag, as for run");
  add_frame_rate_option(command, dense.frame_rate)->group(group);
  add("--camera", dense.camera,
      fmt::format("Camera file, or {}; default: as for the run", camera_names));
  auto* masks = add("--masks", dense.masks,
                    "Folder of masks, for each colour image a PNG of its name, 0 on what is "
                    "static; default: those that `run --save-masks` kept");
  command.add_flag("--no-masks", dense.no_masks, "Fuse all pixels, people too")
      ->group(group)
      ->excludes(masks);
  add("--every", dense.every, "Fuse every so many localised frames")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

}  // namespace dkp_slam::apps
