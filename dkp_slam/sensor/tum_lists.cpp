#include "dkp_slam/sensor/tum_lists.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <tuple>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dkp_slam/error.h"
#include "dkp_slam/input_file.h"

namespace dkp_slam {
namespace {

struct Line {
  int number = 0;  ///< from 1
  std::vector<std::string> words;
};

/// Lines with their words, without comments and empty lines.
std::vector<Line> read_lines(const std::string& path) {
  constexpr std::uintmax_t most_bytes = 1'000'000'000;  // months of frames
  std::ifstream file =
      open_text(path, most_bytes, "cannot be read", "check that it is there and may be read");
  std::vector<Line> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    text.resize(std::min(text.size(), text.find('#')));
    // '\r' comes from lists that were edited on Windows.
    for (char& c : text) {
      if (c == ',' || c == '\t' || c == '\r') c = ' ';
    }
    std::istringstream stream(text);
    Line line{number, {}};
    for (std::string word; stream >> word;) line.words.push_back(word);
    if (!line.words.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

[[noreturn]] void fail(const std::string& path, const Line& line, const std::string& what) {
  throw Error(fmt::format("{}:{}: {}", path, line.number, what));
}

double parse_stamp(const std::string& path, const Line& line, const std::string& word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    fail(path, line, fmt::format("\"{}\" is no time stamp in seconds", word));
  }
  return value;
}

/// Sorts by time stamp and drops repeated ones, with a warning for each kind.
template <typename Item>
void sort_by_stamp(const std::string& path, std::vector<Item>* items) {
  const auto earlier = [](const Item& a, const Item& b) { return a.timestamp < b.timestamp; };
  if (!std::is_sorted(items->begin(), items->end(), earlier)) {
    spdlog::warn("{}: time stamps are out of order; taken in the order of time", path);
    // Stable: of equal time stamps the first line stays first.
    std::stable_sort(items->begin(), items->end(), earlier);
  }
  const auto same = [](const Item& a, const Item& b) { return a.timestamp == b.timestamp; };
  const auto end = std::unique(items->begin(), items->end(), same);
  if (const auto repeated = items->end() - end; repeated > 0) {
    spdlog::warn("{}: {} time stamps occur more than once; the first line of each is taken", path,
                 repeated);
    items->erase(end, items->end());
  }
}

/// Whether a path names a depth image: by its folder, or by its own name when it has no folder.
bool names_depth(const std::string& path) {
  const std::filesystem::path parts(path);
  std::string lower = (parts.has_parent_path() ? parts.parent_path() : parts).filename();
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.find("depth") != std::string::npos;
}

}  // namespace

std::vector<StampedFile> read_stamped_files(const std::string& list) {
  std::vector<StampedFile> files;
  for (const Line& line : read_lines(list)) {
    if (line.words.size() != 2) {
      fail(list, line, "expected \"timestamp path\" (the format allows no spaces in paths)");
    }
    files.push_back({parse_stamp(list, line, line.words[0]), line.words[1]});
  }
  sort_by_stamp(list, &files);
  return files;
}

std::vector<ImagePair> read_associations(const std::string& list) {
  constexpr std::size_t columns = 4;
  std::vector<ImagePair> pairs;
  for (const Line& line : read_lines(list)) {
    if (line.words.size() != columns) {
      fail(list, line,
           "expected \"timestamp path timestamp path\" (the format allows no spaces in paths)");
    }
    const double first = parse_stamp(list, line, line.words[0]);
    const double second = parse_stamp(list, line, line.words[2]);
    const bool depth_first = names_depth(line.words[1]);
    if (depth_first == names_depth(line.words[3])) {
      fail(list, line, "cannot tell colour from depth: one of the two paths must name depth");
    }
    if (depth_first) {
      pairs.push_back({second, line.words[3], line.words[1], first, ""});
    } else {
      pairs.push_back({first, line.words[1], line.words[3], second, ""});
    }
  }
  sort_by_stamp(list, &pairs);
  return pairs;
}

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (begin < b.size() && b[begin] <= a[i] - max_difference) ++begin;
    for (std::size_t j = begin; j < b.size() && b[j] < a[i] + max_difference; ++j) {
      if (const double gap = std::abs(a[i] - b[j]); gap < max_difference) {
        candidates.emplace_back(gap, i, j);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> used_a(a.size(), false), used_b(b.size(), false);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [gap, i, j] : candidates) {
    if (used_a[i] || used_b[j]) continue;
    used_a[i] = used_b[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace dkp_slam
