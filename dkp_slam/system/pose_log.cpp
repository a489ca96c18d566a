#include "dkp_slam/system/pose_log.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

void write(const Se3& pose, double (&rotation)[4], double (&translation)[3]) {
  Eigen::Map<Eigen::Vector4d>(rotation, 4) = pose.rotation.coeffs();  // x, y, z, w
  Eigen::Map<Eigen::Vector3d>(translation, 3) = pose.translation;
}

Se3 pose_from(const double (&rotation)[4], const double (&translation)[3]) {
  return {Eigen::Quaterniond(rotation[3], rotation[0], rotation[1], rotation[2]),
          Eigen::Map<const Eigen::Vector3d>(translation, 3)};
}

}  // namespace

void PoseLog::add(const TrackedPose& pose) {
  newest_.push_back(pose);
  if (newest_.size() < in_memory_ || stays_in_memory_) return;
  if (write_out()) {
    newest_.clear();
    return;
  }
  stays_in_memory_ = true;
  spdlog::warn("poses cannot be written to a temporary file; they stay in memory");
}

bool PoseLog::write_out() {
  if (!file_) file_.reset(std::tmpfile());
  if (!file_) return false;
  std::vector<Record> records;
  records.reserve(newest_.size());
  for (const TrackedPose& p : newest_) {
    Record record{p.timestamp, {}, {}, {}, {}, p.reference_keyframe, p.landmarks, p.continues};
    write(p.camera_from_reference, record.rotation, record.translation);
    if (p.from_previous) write(*p.from_previous, record.motion_rotation, record.motion_translation);
    records.push_back(record);
  }
  // What an earlier failure left behind the last whole record is written over.
  if (std::fseek(file_.get(), static_cast<long>(written_ * sizeof(Record)), SEEK_SET) != 0 ||
      std::fwrite(records.data(), sizeof(Record), records.size(), file_.get()) != records.size() ||
      std::fflush(file_.get()) != 0) {
    return false;
  }
  written_ += records.size();
  return true;
}

void PoseLog::for_each(const std::function<void(const TrackedPose&)>& use) const {
  if (file_) std::rewind(file_.get());
  std::vector<Record> records(in_memory_);
  for (std::size_t read = 0; read < written_;) {
    const std::size_t count = std::min(records.size(), written_ - read);
    if (std::fread(records.data(), sizeof(Record), count, file_.get()) != count) {
      throw Error("the temporary file of poses cannot be read back");
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Record& r = records[i];
      TrackedPose pose;
      pose.timestamp = r.timestamp;
      pose.reference_keyframe = r.reference_keyframe;
      pose.landmarks = r.landmarks;
      pose.continues = r.continues != 0;
      pose.camera_from_reference = pose_from(r.rotation, r.translation);
      const Se3 motion = pose_from(r.motion_rotation, r.motion_translation);
      if (motion.rotation.squaredNorm() > 0.0) pose.from_previous = motion;
      use(pose);
    }
    read += count;
  }
  for (const TrackedPose& p : newest_) use(p);
}

}  // namespace dkp_slam
