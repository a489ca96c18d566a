// A source includes what it uses: where several go through the compiler as one
// (presets core and check), the includes of others would hide that some of its own are missing.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/file_text.h"

namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Text by path, relative to the repository.
using Tree = std::map<std::string, std::string>;
using Names = std::set<std::string>;

/// Which header a name comes from. Not those that every implementation brings along with others.
const std::map<std::string, std::string>& headers() {
  static const std::map<std::string, std::string> all = {
      {"std::any_of", "algorithm"},
      {"std::array", "array"},
      {"std::atomic", "atomic"},
      {"std::clamp", "algorithm"},
      {"std::condition_variable", "condition_variable"},
      {"std::deque", "deque"},
      {"std::find_if", "algorithm"},
      {"std::from_chars", "charconv"},
      {"std::function", "functional"},
      {"std::future", "future"},
      {"std::ifstream", "fstream"},
      {"std::isfinite", "cmath"},
      {"std::istringstream", "sstream"},
      {"std::lock_guard", "mutex"},
      {"std::make_shared", "memory"},
      {"std::make_unique", "memory"},
      {"std::map", "map"},
      {"std::mt19937", "random"},
      {"std::mutex", "mutex"},
      {"std::numeric_limits", "limits"},
      {"std::ofstream", "fstream"},
      {"std::optional", "optional"},
      {"std::ostringstream", "sstream"},
      {"std::regex", "regex"},
      {"std::set", "set"},
      {"std::shared_ptr", "memory"},
      {"std::sort", "algorithm"},
      {"std::span", "span"},
      {"std::sqrt", "cmath"},
      {"std::string", "string"},
      {"std::string_view", "string_view"},
      {"std::thread", "thread"},
      {"std::unique_lock", "mutex"},
      {"std::unique_ptr", "memory"},
      {"std::unordered_map", "unordered_map"},
      {"std::unordered_set", "unordered_set"},
      {"std::variant", "variant"},
      {"std::vector", "vector"},
  };
  return all;
}

Tree sources() {
  const fs::path root = DKP_SLAM_SOURCE_DIR;
  Tree tree;
  for (const char* folder :
       {"apps", "bench", "dkp_slam", "examples", "fuzz", "python", "ros", "tests", "viewer"}) {
    for (auto entry = fs::recursive_directory_iterator(root / folder);
         entry != fs::recursive_directory_iterator(); ++entry) {
      const std::string name = entry->path().filename().string();
      if (name == "node_modules" || name == "build") entry.disable_recursion_pending();
      if (!name.ends_with(".cpp") && !name.ends_with(".h")) continue;
      tree[fs::relative(entry->path(), root).generic_string()] =
          dkp_slam::testing::content(entry->path());
    }
  }
  return tree;
}

/// What the lines "#include" name.
Names includes_of(const std::string& text) {
  Names found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("#include ")) continue;
    const std::size_t from = line.find_first_of("<\"") + 1;
    found.insert(line.substr(from, line.find_first_of(">\"", from) - from));
  }
  return found;
}

/// The headers from elsewhere that a file includes, itself or through those of the tree.
void collect_outside(const Tree& tree, const std::string& path, Names& seen, Names& outside) {
  if (!seen.insert(path).second) return;
  for (const std::string& name : includes_of(tree.at(path))) {
    const std::string beside = (fs::path(path).parent_path() / name).generic_string();
    if (tree.contains(name)) {
      collect_outside(tree, name, seen, outside);
    } else if (tree.contains(beside)) {
      collect_outside(tree, beside, seen, outside);
    } else {
      outside.insert(name);
    }
  }
}

/// Up to the end of the line for a comment, to its own end for text; raw text is not told apart and
/// may hide a line of what follows, or be taken for code.
std::string without_comments_and_text(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (text[i] == '"') {
      for (++i; i < text.size() && text[i] != '"' && text[i] != '\n'; ++i) i += text[i] == '\\';
    } else {
      code += text[i];
    }
  }
  return code;
}

/// Words "std::NAME".
Names standard_names(const std::string& code) {
  Names found;
  for (std::size_t at = code.find("std::"); at != std::string::npos;
       at = code.find("std::", at + 1)) {
    std::size_t end = at + std::string("std::").size();
    while (end < code.size() &&
           (std::isalnum(static_cast<unsigned char>(code[end])) != 0 || code[end] == '_')) {
      ++end;
    }
    found.insert(code.substr(at, end - at));
  }
  return found;
}

std::vector<std::string> problems_in(const Tree& tree) {
  std::vector<std::string> problems;
  for (const auto& [path, text] : tree) {
    Names seen, outside;
    collect_outside(tree, path, seen, outside);
    for (const std::string& name : standard_names(without_comments_and_text(text))) {
      const auto header = headers().find(name);
      if (header == headers().end() || outside.contains(header->second)) continue;
      problems.push_back(path + ": uses " + name + ", so it must include <" + header->second + ">");
    }
  }
  return problems;
}

TEST(Includes, EverySourceIncludesWhatItUses) { EXPECT_THAT(problems_in(sources()), IsEmpty()); }

TEST(Includes, FindsWhatIsMissing) {
  EXPECT_THAT(problems_in({{"a.h", "#include <optional>\nstd::optional<int> a;\n"},
                           {"b.cpp", "#include \"a.h\"\n// std::map\nstd::optional<int> b;\n"},
                           {"c.cpp",
                            "std::optional<int> c;\nconst char* d = \"std::map \\\" std::map\";\n"
                            "std::function<void()> e;\n"}}),
              ElementsAre("c.cpp: uses std::function, so it must include <functional>",
                          "c.cpp: uses std::optional, so it must include <optional>"));
}

}  // namespace
