#include "dkp_slam/evaluation/measure/timings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  std::string field;
  while (std::getline(in, field, ',')) fields.push_back(field);
  return fields;
}

}  // namespace

std::map<std::string, std::vector<double>> read_timings(const std::string& csv) {
  std::istringstream in(csv);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = fields_of(line);
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw Error(
          fmt::format("timings.csv:1: two columns are called '{}'; run it again", names[i]));
    }
  }
  std::map<std::string, std::vector<double>> columns;
  for (int number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> fields = fields_of(line);
    if (fields.size() != names.size()) {
      throw Error(fmt::format("timings.csv:{}: {} fields, the header has {}; run it again", number,
                              fields.size(), names.size()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string& field = fields[i];
      double value = 0.0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
      if (error != std::errc() || end != field.data() + field.size() || std::isnan(value)) {
        throw Error(fmt::format("timings.csv:{}: {}: '{}' is no number; run it again", number,
                                names[i], field));
      }
      columns[names[i]].push_back(value);
    }
  }
  if (columns.empty()) throw Error("timings.csv: holds no frame; run it again");
  return columns;
}

}  // namespace dkp_slam
