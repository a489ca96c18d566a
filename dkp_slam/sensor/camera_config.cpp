#include "dkp_slam/sensor/camera_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam {
namespace {

const std::vector<std::string> required_keys = {"width", "height", "fx",         "fy",
                                                "cx",    "cy",     "depth_scale"};

/// One map of the file, whose fields must each be asked for by name.
class Fields {
 public:
  Fields(const std::string& path, const YAML::Node& map, std::vector<std::string> valid_keys,
         const std::string& prefix = "")
      : path_(path), prefix_(prefix) {
    if (!map.IsMap()) fail(map.Mark().line, "expected lines of the form \"key: value\"");
    for (const auto& item : map) {
      const int line = item.first.Mark().line;
      if (!item.first.IsScalar()) fail(line, "a key's name must stand before the colon");
      const std::string& key = item.first.Scalar();
      if (std::find(valid_keys.begin(), valid_keys.end(), key) == valid_keys.end()) {
        fail(line, fmt::format("unknown key {}{}; valid keys are {}", prefix_, key,
                               fmt::join(valid_keys, ", ")));
      }
      if (const auto [first, added] = nodes_.emplace(key, item.second); !added) {
        fail(line, fmt::format("{}{} was set before on line {}; keep one of them", prefix_, key,
                               first->second.Mark().line + 1));
      }
      lines_[key] = line;
    }
  }

  bool has(const std::string& key) const { return nodes_.count(key) != 0; }
  const YAML::Node& node(const std::string& key) const { return nodes_.at(key); }

  /// Leaves `value` as it is when the key is absent.
  void get(const std::string& key, double* value) const {
    if (has(key)) *value = number(key, node(key));
  }
  void get(const std::string& key, int* value) const {
    if (!has(key)) return;
    if (!node(key).IsScalar() || !YAML::convert<int>::decode(node(key), *value)) {
      fail(key, "must be a whole number");
    }
  }
  void get(const std::string& key, std::string* value) const {
    if (!has(key)) return;
    if (!node(key).IsScalar()) fail(key, "must be text");
    *value = node(key).Scalar();
  }

  double number(const std::string& key, const YAML::Node& scalar) const {
    double value = 0.0;
    if (!scalar.IsScalar() || !YAML::convert<double>::decode(scalar, value)) {
      fail(key, scalar.IsScalar() ? fmt::format("must be a number, not \"{}\"", scalar.Scalar())
                                  : "must be a number");
    }
    if (!std::isfinite(value)) fail(key, "must be finite, not " + scalar.Scalar());
    return value;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    const auto line = lines_.find(key);
    fail(line == lines_.end() ? 0 : line->second, fmt::format("{}{}: {}", prefix_, key, what));
  }
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw Error(fmt::format("{}:{}: {}", path_, std::max(line, 0) + 1, what));
  }

 private:
  std::string path_;
  std::string prefix_;
  std::map<std::string, YAML::Node> nodes_;
  std::map<std::string, int> lines_;  ///< from 0
};

/// Of a key that is there; `wanted`: what it must be.
template <std::size_t Size>
std::array<double, Size> read_numbers(const Fields& fields, const std::string& key,
                                      const char* wanted) {
  const YAML::Node& node = fields.node(key);
  if (!node.IsSequence() || node.size() != Size) fields.fail(key, wanted);
  std::array<double, Size> values{};
  for (std::size_t i = 0; i < Size; ++i) values[i] = fields.number(key, node[i]);
  return values;
}

Distortion read_distortion(const Fields& fields) {
  const auto values = read_numbers<5>(
      fields, "distortion", "must be five numbers, [k1, k2, p1, p2, k3]; 0 for those unknown");
  return {values[0], values[1], values[2], values[3], values[4]};
}

DepthDistortion read_depth_distortion(const Fields& fields) {
  const std::string key = "depth_distortion";
  const auto values = read_numbers<DepthDistortion::size>(
      fields, key,
      "must be nine numbers, those of x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3; 0 for those "
      "unknown");
  constexpr double most = 0.1;  // 1/metre: a tenth of the depth at one metre
  DepthDistortion distortion;
  for (int i = 0; i < DepthDistortion::size; ++i) {
    distortion.coefficients[i] = values[static_cast<std::size_t>(i)];
    if (std::abs(distortion.coefficients[i]) > most) {
      fields.fail(key, "must be numbers between -0.1 and 0.1 1/metre");
    }
  }
  return distortion;
}

YAML::Node parse_file(const std::string& path) {
  constexpr std::uintmax_t most_bytes = 1'000'000;
  std::ifstream stream =
      open_text(path, most_bytes, "cannot read the camera file", "give the camera's YAML file");
  try {
    return YAML::Load(stream);
  } catch (const YAML::Exception& error) {
    throw Error(fmt::format("{}:{}: not valid YAML: {}", path, error.mark.line + 1, error.msg));
  }
}

Fields read_fields(const std::string& path, const YAML::Node& node) {
  return {path,
          node,
          {"name", "width", "height", "fx", "fy", "cx", "cy", "distortion", "depth_scale",
           "depth_delay", "depth_bias", "depth_distortion", "min_depth", "max_depth", "baseline",
           "frame_rate", "readout", "depth_readout", "depth_noise"}};
}

/// Throws where a value is so large that it must have another unit.
DepthCorrection read_depth_correction(const Fields& fields) {
  constexpr double most = 0.5;  // seconds, metres
  DepthCorrection depth;
  fields.get("depth_delay", &depth.delay);
  fields.get("depth_bias", &depth.bias);
  if (std::abs(depth.delay) > most) {
    fields.fail("depth_delay", "must lie between -0.5 and 0.5 seconds");
  }
  if (std::abs(depth.bias) > most) {
    fields.fail("depth_bias", "must lie between -0.5 and 0.5 metres");
  }
  if (fields.has("depth_distortion")) depth.distortion = read_depth_distortion(fields);
  return depth;
}

/// `path`: for messages.
Camera camera_of(const std::string& path, const YAML::Node& node) {
  const Fields fields = read_fields(path, node);
  for (const std::string& key : required_keys) {
    if (!fields.has(key)) throw Error(fmt::format("{}: {} is missing; add it", path, key));
  }
  Camera camera;
  fields.get("name", &camera.name);
  fields.get("width", &camera.width);
  fields.get("height", &camera.height);
  fields.get("fx", &camera.fx);
  fields.get("fy", &camera.fy);
  fields.get("cx", &camera.cx);
  fields.get("cy", &camera.cy);
  if (fields.has("distortion")) camera.distortion = read_distortion(fields);
  fields.get("depth_scale", &camera.depth_scale);
  fields.get("min_depth", &camera.min_depth);
  fields.get("max_depth", &camera.max_depth);
  fields.get("baseline", &camera.baseline);
  fields.get("frame_rate", &camera.frame_rate);
  fields.get("readout", &camera.readout);
  if (fields.has("depth_readout")) fields.get("depth_readout", &camera.depth_readout.emplace());
  if (fields.has("depth_noise")) {
    const Fields noise(path, fields.node("depth_noise"), {"constant", "quadratic"}, "depth_noise.");
    noise.get("constant", &camera.depth_noise.constant);
    noise.get("quadratic", &camera.depth_noise.quadratic);
  }
  camera.depth_correction = read_depth_correction(fields);
  if (const auto reason = camera.check()) {
    // The reason begins with the field's name, which gives the line.
    const std::string key = reason->substr(0, reason->find(' '));
    fields.fail(key, *reason);
  }
  return camera;
}

}  // namespace

Camera load_camera(const std::string& path) { return camera_of(path, parse_file(path)); }

Camera parse_camera(const std::string& text, const std::string& name) {
  YAML::Node node;
  try {
    node = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error(fmt::format("{}:{}: not valid YAML: {}", name, error.mark.line + 1, error.msg));
  }
  return camera_of(name, node);
}

std::string camera_text(const Camera& camera) {
  const DepthCorrection& depth = camera.depth_correction;
  const Distortion& d = camera.distortion;
  std::string text;
  const auto line = [&text](const std::string& item, const char* comment) {
    text += fmt::format("{:<34} # {}\n", item, comment);
  };
  YAML::Emitter name;
  name << YAML::DoubleQuoted << camera.name;
  line(fmt::format("name: {}", name.c_str()), "for reports");
  line(fmt::format("width: {}", camera.width), "pixels");
  line(fmt::format("height: {}", camera.height), "pixels");
  line(fmt::format("fx: {}", camera.fx), "pixels, focal length");
  line(fmt::format("fy: {}", camera.fy), "pixels");
  line(fmt::format("cx: {}", camera.cx),
       "pixels, principal point; top left pixel's centre is 0, 0");
  line(fmt::format("cy: {}", camera.cy), "pixels");
  line(fmt::format("distortion: [{}, {}, {}, {}, {}]", d.k1, d.k2, d.p1, d.p2, d.k3),
       "k1, k2, p1, p2, k3 as in OpenCV");
  line(fmt::format("depth_scale: {}", camera.depth_scale), "depth image units per metre");
  line(fmt::format("depth_delay: {}", depth.delay), "seconds, of depth after its time stamp");
  line(fmt::format("depth_bias: {}", depth.bias), "metres to be added to each depth");
  if (!depth.distortion.none()) {
    text += fmt::format("depth_distortion: [{}]  # 1/metre, see docs/calibration.md\n",
                        fmt::join(depth.distortion.coefficients, ", "));
  }
  line(fmt::format("min_depth: {}", camera.min_depth), "metres; nearer readings are unknown");
  line(fmt::format("max_depth: {}", camera.max_depth), "metres; farther readings are unknown");
  line(fmt::format("baseline: {}", camera.baseline), "metres, of the virtual right camera");
  line(fmt::format("frame_rate: {}", camera.frame_rate), "colour images per second");
  line(fmt::format("readout: {}", camera.readout),
       "seconds from the first row to the last; 0: all at once");
  if (camera.depth_readout)
    line(fmt::format("depth_readout: {}", *camera.depth_readout), "seconds, the same of depth");
  text += "depth_noise:\n";
  line(fmt::format("  constant: {}", camera.depth_noise.constant), "metres");
  line(fmt::format("  quadratic: {}", camera.depth_noise.quadratic), "1/metre");
  return text;
}

void save_camera(const Camera& camera, const std::string& path) {
  std::ofstream file(path);
  file << camera_text(camera);
  file.close();
  if (!file) throw Error(path + ": cannot write the camera file");
}

}  // namespace dkp_slam
