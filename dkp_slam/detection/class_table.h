#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

namespace dkp_slam {

/// The COCO classes and the dynamic weight W of each (paper §3.5 step 2; algorithm.md, §3.2).
///
/// W runs from 1 (fixed: its boxes are ignored) to 10 (moves by itself). In between stand things
/// that move only while somebody carries or pushes them. Their boxes are frequent in a still
/// office (chairs, laptops, books), so the weight says how much evidence of motion a feature in
/// them needs, and whoever uses it decides whether a class below 10 is cut out without any.
class ClassTable {
 public:
  static constexpr int class_count = 80;

  /// The built-in weights, the same as in config/classes.yaml.
  ClassTable();
  /// The built-in weights with those of a YAML file (form: config/classes.yaml) over them. Throws
  /// `Error` with file and line on an unknown class or a weight outside 1..10.
  static ClassTable load(const std::filesystem::path& file);

  /// Weight of a class, 1..10; 10 for `Detection::motion_class`. `class_id` must be known.
  float weight(int class_id) const;
  void set_weight(int class_id, float weight);

  /// COCO name of a class, "moving" for `Detection::motion_class`, "unknown" for any other.
  static std::string_view name(int class_id);
  /// Class of a COCO name, or nothing.
  static std::optional<int> find(std::string_view name);

 private:
  std::array<float, class_count> weights_;
};

}  // namespace dkp_slam
