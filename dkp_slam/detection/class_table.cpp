#include "dkp_slam/detection/class_table.h"

#include <algorithm>
#include <string>

#include <yaml-cpp/yaml.h>

#include "dkp_slam/detection/detector.h"
#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam {
namespace {

struct ClassEntry {
  std::string_view name;
  float weight;
};

// Living things move by themselves (10). Vehicles move, but rarely in a room (8). What is carried
// while its bearer walks (6), what is pushed or picked up now and then (3 to 5). Furniture, fixed
// appliances, and small things that lie about and hold few features: 1.
constexpr std::array<ClassEntry, ClassTable::class_count> coco{{
    {"person", 10},       {"bicycle", 8},      {"car", 8},
    {"motorcycle", 8},    {"airplane", 8},     {"bus", 8},
    {"train", 8},         {"truck", 8},        {"boat", 8},
    {"traffic light", 1}, {"fire hydrant", 1}, {"stop sign", 1},
    {"parking meter", 1}, {"bench", 1},        {"bird", 10},
    {"cat", 10},          {"dog", 10},         {"horse", 10},
    {"sheep", 10},        {"cow", 10},         {"elephant", 10},
    {"bear", 10},         {"zebra", 10},       {"giraffe", 10},
    {"backpack", 6},      {"umbrella", 6},     {"handbag", 6},
    {"tie", 6},           {"suitcase", 6},     {"frisbee", 6},
    {"skis", 6},          {"snowboard", 6},    {"sports ball", 6},
    {"kite", 6},          {"baseball bat", 6}, {"baseball glove", 6},
    {"skateboard", 6},    {"surfboard", 6},    {"tennis racket", 6},
    {"bottle", 3},        {"wine glass", 3},   {"cup", 3},
    {"fork", 1},          {"knife", 1},        {"spoon", 1},
    {"bowl", 1},          {"banana", 1},       {"apple", 1},
    {"sandwich", 1},      {"orange", 1},       {"broccoli", 1},
    {"carrot", 1},        {"hot dog", 1},      {"pizza", 1},
    {"donut", 1},         {"cake", 1},         {"chair", 4},
    {"couch", 1},         {"potted plant", 1}, {"bed", 1},
    {"dining table", 1},  {"toilet", 1},       {"tv", 1},
    {"laptop", 3},        {"mouse", 1},        {"remote", 1},
    {"keyboard", 1},      {"cell phone", 5},   {"microwave", 1},
    {"oven", 1},          {"toaster", 1},      {"sink", 1},
    {"refrigerator", 1},  {"book", 3},         {"clock", 1},
    {"vase", 1},          {"scissors", 1},     {"teddy bear", 3},
    {"hair drier", 1},    {"toothbrush", 1},
}};

bool valid_weight(float weight) { return weight >= 1.0F && weight <= 10.0F; }

[[noreturn]] void fail(const std::filesystem::path& file, const YAML::Mark& mark,
                       const std::string& what) {
  throw Error(file.string() + ":" + std::to_string(mark.line + 1) + ": " + what +
              "; see config/classes.yaml for the form");
}

}  // namespace

ClassTable::ClassTable() {
  std::transform(coco.begin(), coco.end(), weights_.begin(),
                 [](const ClassEntry& entry) { return entry.weight; });
}

ClassTable ClassTable::load(const std::filesystem::path& file) {
  constexpr std::uintmax_t most_bytes = 1'000'000;
  std::ifstream stream =
      open_text(file, most_bytes, "cannot read the class weights", "check the path");
  YAML::Node root;
  try {
    root = YAML::Load(stream);
  } catch (const YAML::ParserException& error) {
    fail(file, error.mark, "not YAML: " + error.msg);
  }
  const YAML::Node weights = root.IsMap() ? root["weights"] : YAML::Node();
  if (!weights.IsDefined() || !weights.IsMap()) {
    fail(file, root.Mark(), "no map 'weights' of class names to numbers from 1 to 10");
  }
  ClassTable table;
  for (const auto& entry : weights) {
    const std::string name = entry.first.as<std::string>("");
    const std::optional<int> id = find(name);
    if (!id) fail(file, entry.first.Mark(), "'" + name + "' is not a COCO class");
    const float weight = entry.second.as<float>(0.0F);
    if (!valid_weight(weight)) {
      fail(file, entry.second.Mark(), "the weight of '" + name + "' must be from 1 to 10");
    }
    table.set_weight(*id, weight);
  }
  return table;
}

float ClassTable::weight(int class_id) const {
  if (class_id == Detection::motion_class) return 10.0F;
  return weights_.at(static_cast<std::size_t>(class_id));
}

void ClassTable::set_weight(int class_id, float weight) {
  if (!valid_weight(weight)) throw Error("a class weight must be from 1 to 10");
  weights_.at(static_cast<std::size_t>(class_id)) = weight;
}

std::string_view ClassTable::name(int class_id) {
  if (class_id == Detection::motion_class) return "moving";
  if (class_id < 0 || class_id >= class_count) return "unknown";
  return coco[static_cast<std::size_t>(class_id)].name;
}

std::optional<int> ClassTable::find(std::string_view name) {
  const auto entry =
      std::find_if(coco.begin(), coco.end(), [&](const ClassEntry& e) { return e.name == name; });
  if (entry == coco.end()) return std::nullopt;
  return static_cast<int>(entry - coco.begin());
}

}  // namespace dkp_slam
