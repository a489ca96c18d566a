#include "dkp_slam/export/path_formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "dkp_slam/error.h"
#include "dkp_slam/export/atomic_file.h"
#include "dkp_slam/export/trajectory.h"

namespace dkp_slam {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF's numbers are copied as they lie");

using Poses = std::span<const StampedPose>;

/// qw not negative, so that the same pose gives the same bytes.
Eigen::Quaterniond rotation_of(const StampedPose& pose) {
  Eigen::Quaterniond q = pose.world_from_camera.rotation.normalized();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return q;
}

std::string tum(Poses poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : poses) text += trajectory_line(pose);
  return text;
}

std::string kitti(Poses poses) {
  // Nine digits, and no minus before what is 0 by then.
  const auto digits = [](double v) { return std::round(v * 1e9) / 1e9 + 0.0; };
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Matrix3d r = rotation_of(pose).toRotationMatrix();
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    for (int row = 0; row < 3; ++row) {
      text += fmt::format("{:.9f} {:.9f} {:.9f} {:.9f}{}", digits(r(row, 0)), digits(r(row, 1)),
                          digits(r(row, 2)), digits(t(row)), row < 2 ? ' ' : '\n');
    }
  }
  return text;
}

std::string euroc(Poses poses) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z "
      "[]\n";
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond q = rotation_of(pose);
    // To the microsecond, as everywhere: a double of a Unix time has no more.
    text += fmt::format("{}000,{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                        std::llround(pose.timestamp * 1e6), t.x(), t.y(), t.z(), q.w(), q.x(),
                        q.y(), q.z());
  }
  return text;
}

std::string ply(Poses poses) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment camera path, metres\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\nproperty double timestamp\n"
      "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
      poses.size(), poses.size() - 1);
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    text += fmt::format("{:.6f} {:.6f} {:.6f} {:.6f}\n", t.x(), t.y(), t.z(), pose.timestamp);
  }
  for (std::size_t i = 1; i < poses.size(); ++i) text += fmt::format("{} {}\n", i - 1, i);
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t value = 0;
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      value = value << 8U | (k < there ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= there ? digits[value >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

std::string gltf(Poses poses) {
  std::string bytes;
  Eigen::Array3f low = Eigen::Array3f::Constant(INFINITY), high = -low;
  for (const StampedPose& pose : poses) {
    // The camera's x right, y down, z forward.
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Vector3f at = Eigen::Vector3d(t.x(), -t.y(), -t.z()).cast<float>();
    low = low.min(at.array());
    high = high.max(at.array());
    bytes.append(reinterpret_cast<const char*>(at.data()), 3 * sizeof(float));
  }
  const auto triple = [](const Eigen::Array3f& v) {
    return fmt::format("[{},{},{}]", v.x(), v.y(), v.z());
  };
  constexpr int floats = 5126, vertices = 34962, line_strip = 3;  // glTF 2.0, 3.6 and 3.7
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"dkp-slam"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"name":"camera path","mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":{}}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":{},"count":{},"type":"VEC3","min":{},"max":{}}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{},"target":{}}}],)"
      R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})"
      "\n",
      +line_strip, +floats, poses.size(), triple(low), triple(high), bytes.size(), +vertices,
      bytes.size(), base64(bytes));
}

void check(Poses poses) {
  if (poses.empty()) throw Error("there is no pose to write");
  for (const StampedPose& pose : poses) {
    const Se3& p = pose.world_from_camera;
    if (!std::isfinite(pose.timestamp) || !p.translation.allFinite() ||
        !p.rotation.coeffs().allFinite()) {
      throw Error(fmt::format("the pose at {:.6f} s is not finite; leave it out", pose.timestamp));
    }
  }
}

}  // namespace

const std::vector<PathFormatInfo>& path_formats() {
  static const std::vector<PathFormatInfo> all = {{PathFormat::tum, "tum", ".txt"},
                                                  {PathFormat::kitti, "kitti", ".kitti.txt"},
                                                  {PathFormat::euroc, "euroc", ".euroc.csv"},
                                                  {PathFormat::ply, "ply", ".ply"},
                                                  {PathFormat::gltf, "gltf", ".gltf"}};
  return all;
}

std::string path_text(PathFormat format, Poses poses) {
  check(poses);
  switch (format) {
    case PathFormat::kitti:
      return kitti(poses);
    case PathFormat::euroc:
      return euroc(poses);
    case PathFormat::ply:
      return ply(poses);
    case PathFormat::gltf:
      return gltf(poses);
    case PathFormat::tum:
      break;
  }
  return tum(poses);
}

void write_path(PathFormat format, const std::filesystem::path& file, Poses poses) {
  std::string text;
  try {
    text = path_text(format, poses);
  } catch (const Error& error) {
    throw Error(fmt::format("cannot write {}: {}", file.string(), error.what()));
  }
  write_file_atomically(file, text);
}

}  // namespace dkp_slam
