// The order of the folders holds: reads all sources and fails where docs/architecture.md does not.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/file_text.h"

namespace {

namespace fs = std::filesystem;
using dkp_slam::testing::content;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t most_lines = 450;
/// Made by CMake, so not in the tree of sources.
const std::set<std::string> generated = {"dkp_slam/version.h"};

using Problems = std::vector<std::string>;
/// Text by path, relative to the repository.
using Tree = std::map<std::string, std::string>;
using Graph = std::map<std::string, std::set<std::string>>;

bool ends_with_any(const std::string& text, const std::vector<std::string>& endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const std::string& ending) { return text.ends_with(ending); });
}

bool is_source(const std::string& path) {
  return ends_with_any(path, {".h", ".hpp", ".hh", ".cpp", ".cc", ".cxx"});
}

std::string name_of(const std::string& path) { return fs::path(path).filename().string(); }
std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

/// Tests, what helps them, and the programs that they start: these may include anything.
bool serves_tests(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  return stem.ends_with("_test") || stem.ends_with("_child") || stem.starts_with("test_") ||
         stem.find("_test_") != std::string::npos;
}

Tree sources_under(const std::vector<std::string>& folders) {
  const fs::path root = DKP_SLAM_SOURCE_DIR;
  Tree tree;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = fs::relative(entry.path(), root).generic_string();
      if (is_source(path) || name_of(path) == "CMakeLists.txt") tree[path] = content(entry.path());
    }
  }
  return tree;
}

std::vector<std::string> quoted_includes(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  static const std::regex form(R"re(^\s*#\s*include\s*"([^"]+)")re");
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, form)) found.push_back(match[1]);
  }
  return found;
}

/// Folders of dkp_slam/ in the order of the page's table, the lowest first.
std::vector<std::string> folders_of(const std::string& page) {
  std::vector<std::string> folders;
  std::istringstream lines(page);
  static const std::regex row(R"(^\| `(dkp_slam[a-z_0-9/]*)` \|)");
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, row)) folders.push_back(match[1]);
  }
  return folders;
}

/// Place in the list, or -1.
int place_of(const std::vector<std::string>& folders, const std::string& folder) {
  const auto found = std::find(folders.begin(), folders.end(), folder);
  return found == folders.end() ? -1 : static_cast<int>(found - folders.begin());
}

/// "a -> b -> a", or nothing where there is none.
std::string circle_in(const Graph& graph) {
  std::set<std::string> done;
  std::vector<std::string> way;
  std::string circle;
  const std::function<void(const std::string&)> visit = [&](const std::string& node) {
    if (!circle.empty() || done.contains(node)) return;
    if (const auto seen = std::find(way.begin(), way.end(), node); seen != way.end()) {
      for (auto i = seen; i != way.end(); ++i) circle += *i + " -> ";
      circle += node;
      return;
    }
    way.push_back(node);
    if (const auto next = graph.find(node); next != graph.end()) {
      for (const std::string& other : next->second) visit(other);
    }
    way.pop_back();
    done.insert(node);
  };
  for (const auto& [node, others] : graph) visit(node);
  return circle;
}

/// A header and the source of the same name count as one.
std::string unit_of(const std::string& path) {
  return fs::path(path).replace_extension().generic_string();
}

Problems include_problems(const Tree& tree, const std::vector<std::string>& folders) {
  Problems problems;
  Graph between_folders, between_units;
  for (const auto& [path, text] : tree) {
    if (!is_source(path) || serves_tests(path) || !path.starts_with("dkp_slam/")) continue;
    const std::string folder = folder_of(path);
    if (place_of(folders, folder) < 0) {
      problems.push_back(path + ": its folder is not in the table of docs/architecture.md");
      continue;
    }
    for (const std::string& other : quoted_includes(text)) {
      if (generated.contains(other)) continue;
      if (!tree.contains(other) || !other.starts_with("dkp_slam/")) {
        problems.push_back(path + ": includes " + other + ", which the core does not have");
        continue;
      }
      if (serves_tests(other)) problems.push_back(path + ": includes " + other + ", of the tests");
      if (place_of(folders, folder_of(other)) > place_of(folders, folder))
        problems.push_back(path + ": includes " + other + ", which is above it");
      if (folder_of(other) != folder) between_folders[folder].insert(folder_of(other));
      if (unit_of(other) != unit_of(path)) between_units[unit_of(path)].insert(unit_of(other));
    }
  }
  for (const Graph* graph : {&between_folders, &between_units}) {
    if (const std::string circle = circle_in(*graph); !circle.empty())
      problems.push_back("a circle: " + circle);
  }
  return problems;
}

/// What the CMake target of each folder says of itself: its name, and that it uses only what is
/// below it.
Problems target_problems(const Tree& tree, const std::vector<std::string>& folders) {
  std::vector<std::string> targets;
  for (const std::string& folder : folders) {
    std::string name = folder == "dkp_slam" ? "base" : folder.substr(sizeof("dkp_slam"));
    std::replace(name.begin(), name.end(), '/', '_');
    targets.push_back(name);
  }
  static const std::regex call(R"(dkp_slam_library\(\s*(\w+)([^)]*)\))");
  Problems problems;
  for (const auto& [path, text] : tree) {
    if (name_of(path) != "CMakeLists.txt") continue;
    std::smatch match;
    if (!std::regex_search(text, match, call)) continue;
    const int own = place_of(targets, match[1]);
    if (own < 0 || own != place_of(folders, folder_of(path))) {
      problems.push_back(path + ": target " + match[1].str() + " is not named as its folder, or " +
                         "that is not in the table of docs/architecture.md");
      continue;
    }
    std::istringstream words(match[2]);
    bool uses = false;
    for (std::string word; words >> word;) {
      if (std::isupper(static_cast<unsigned char>(word[0]))) {
        uses = word == "USES";
      } else if (uses && (place_of(targets, word) < 0 || place_of(targets, word) >= own)) {
        problems.push_back(path + ": uses " + word + ", which is not below it");
      }
    }
  }
  return problems;
}

Problems form_problems(const Tree& tree) {
  static const std::regex name(R"([a-z][a-z0-9_]*\.(h|cpp))");
  Problems problems;
  for (const auto& [path, text] : tree) {
    if (!is_source(path)) continue;
    if (!std::regex_match(name_of(path), name))
      problems.push_back(path + ": names are words_with_underscores.h or .cpp");
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    if (lines > most_lines)
      problems.push_back(path + ": " + std::to_string(lines) + " lines, more than " +
                         std::to_string(most_lines));
    if (path.ends_with(".h") && !text.starts_with("#pragma once\n"))
      problems.push_back(path + ": does not begin with #pragma once");
    for (const std::string& other : quoted_includes(text)) {
      if (other.ends_with(".cpp")) problems.push_back(path + ": includes the source " + other);
    }
  }
  return problems;
}

/// Paths in `backticks` that begin with a folder of the repository, and are not there.
Problems dead_paths(const std::string& page) {
  const fs::path root = DKP_SLAM_SOURCE_DIR;
  static const std::regex path(
      R"(`((?:apps|bench|cmake|config|dkp_slam|docs|examples|python|scripts|tests|viewer)/[A-Za-z0-9_./-]*)`)");
  Problems problems;
  const std::string text = content(root / page);
  if (text.empty()) problems.push_back(page + " is not there");
  for (std::sregex_iterator i(text.begin(), text.end(), path), end; i != end; ++i) {
    if (!fs::exists(root / (*i)[1].str()))
      problems.push_back(page + " names " + (*i)[1].str() + ", which is not there");
  }
  return problems;
}

std::vector<std::string> page_folders() {
  return folders_of(content(fs::path(DKP_SLAM_SOURCE_DIR) / "docs/architecture.md"));
}

TEST(Architecture, IncludesGoDownTheListOfFoldersOnly) {
  EXPECT_THAT(include_problems(sources_under({"dkp_slam"}), page_folders()), IsEmpty());
}

TEST(Architecture, TargetsUseOnlyFoldersBelowThem) {
  EXPECT_THAT(target_problems(sources_under({"dkp_slam"}), page_folders()), IsEmpty());
}

TEST(Architecture, EveryFolderOfTheListIsThereOnce) {
  const auto folders = page_folders();
  ASSERT_GT(folders.size(), 10U) << "the table of docs/architecture.md was not found";
  EXPECT_EQ(std::set(folders.begin(), folders.end()).size(), folders.size());
  for (const std::string& folder : folders)
    EXPECT_TRUE(fs::is_directory(fs::path(DKP_SLAM_SOURCE_DIR) / folder)) << folder;
}

TEST(Architecture, FilesAreShortAndNamedAlike) {
  EXPECT_THAT(form_problems(sources_under(
                  {"apps", "bench", "dkp_slam", "examples", "python", "tests", "viewer"})),
              IsEmpty());
}

TEST(Architecture, PagesNameFilesThatAreThere) {
  for (const char* page : {"README.md", "CONTRIBUTING.md", "docs/architecture.md", "docs/view.md"})
    EXPECT_THAT(dead_paths(page), IsEmpty());
}

// The checks themselves, on trees with one fault each.

const std::vector<std::string> two_folders = {"dkp_slam/low", "dkp_slam/high"};

Problems problems_of(const Tree& tree) { return include_problems(tree, two_folders); }

TEST(ArchitectureChecks, FindNothingInAGoodTree) {
  const Tree tree = {{"dkp_slam/low/a.h", "#pragma once\n"},
                     {"dkp_slam/low/a.cpp", "#include \"dkp_slam/low/a.h\"\n"},
                     {"dkp_slam/low/a_test.cpp", "#include \"dkp_slam/high/b.h\"\n"},
                     {"dkp_slam/low/CMakeLists.txt", "dkp_slam_library(low SOURCES a.cpp)\n"},
                     {"dkp_slam/high/CMakeLists.txt", "dkp_slam_library(high\n  USES low LINK x)"},
                     {"dkp_slam/high/b.h", "#pragma once\n#include \"dkp_slam/low/a.h\"\n"}};
  EXPECT_THAT(problems_of(tree), IsEmpty());
  EXPECT_THAT(target_problems(tree, two_folders), IsEmpty());
  EXPECT_THAT(form_problems(tree), IsEmpty());
}

TEST(ArchitectureChecks, FindAnIncludeThatGoesUp) {
  EXPECT_THAT(problems_of({{"dkp_slam/low/a.cpp", "#include \"dkp_slam/high/b.h\"\n"},
                           {"dkp_slam/high/b.h", ""}}),
              ElementsAre("dkp_slam/low/a.cpp: includes dkp_slam/high/b.h, which is above it"));
}

TEST(ArchitectureChecks, FindACircleOfFolders) {
  const Problems problems = problems_of({{"dkp_slam/low/a.h", "#include \"dkp_slam/high/b.h\"\n"},
                                         {"dkp_slam/low/c.h", ""},
                                         {"dkp_slam/high/b.h", "#include \"dkp_slam/low/c.h\"\n"}});
  EXPECT_THAT(problems,
              ::testing::Contains("a circle: dkp_slam/high -> dkp_slam/low -> dkp_slam/high"));
}

TEST(ArchitectureChecks, FindACircleOfFilesThroughTheirSources) {
  EXPECT_THAT(problems_of({{"dkp_slam/low/a.h", ""},
                           {"dkp_slam/low/a.cpp", "#include \"dkp_slam/low/b.h\"\n"},
                           {"dkp_slam/low/b.h", ""},
                           {"dkp_slam/low/b.cpp", "#include \"dkp_slam/low/c.h\"\n"},
                           {"dkp_slam/low/c.h", "#include \"dkp_slam/low/a.h\"\n"}}),
              ElementsAre("a circle: dkp_slam/low/a -> dkp_slam/low/b -> dkp_slam/low/c -> "
                          "dkp_slam/low/a"));
}

TEST(ArchitectureChecks, FindFoldersAndFilesThatAreNotThere) {
  EXPECT_THAT(problems_of({{"dkp_slam/new/a.cpp", ""}}),
              ElementsAre(HasSubstr("not in the table of docs/architecture.md")));
  EXPECT_THAT(problems_of({{"dkp_slam/low/a.cpp", "#include \"apps/commands.h\"\n"}}),
              ElementsAre(HasSubstr("which the core does not have")));
  EXPECT_THAT(problems_of({{"dkp_slam/low/a.cpp", "#include \"dkp_slam/low/test_map.h\"\n"},
                           {"dkp_slam/low/test_map.h", ""}}),
              ElementsAre(HasSubstr("of the tests")));
}

TEST(ArchitectureChecks, FindATargetThatUsesWhatIsAboveIt) {
  EXPECT_THAT(target_problems({{"dkp_slam/low/CMakeLists.txt",
                                "dkp_slam_library(low SOURCES a.cpp USES high PRIVATE x)\n"}},
                              two_folders),
              ElementsAre("dkp_slam/low/CMakeLists.txt: uses high, which is not below it"));
  EXPECT_THAT(
      target_problems({{"dkp_slam/low/CMakeLists.txt", "dkp_slam_library(other)\n"}}, two_folders),
      ElementsAre(HasSubstr("is not named as its folder")));
}

TEST(ArchitectureChecks, FindFilesOfAnotherForm) {
  std::string many_lines = "#pragma once\n";
  for (std::size_t i = 0; i < most_lines; ++i) many_lines += "\n";
  EXPECT_THAT(form_problems({{"apps/a.h", many_lines}}), ElementsAre(HasSubstr("451 lines")));
  EXPECT_THAT(form_problems({{"apps/a.h", "#ifndef A_H\n"}}),
              ElementsAre(HasSubstr("#pragma once")));
  EXPECT_THAT(form_problems({{"apps/MyFile.cpp", ""}, {"apps/file.cc", ""}}),
              ElementsAre(HasSubstr("MyFile.cpp: names"), HasSubstr("file.cc: names")));
  EXPECT_THAT(form_problems({{"apps/a.cpp", "  #  include \"apps/b.cpp\"\n"}}),
              ElementsAre(HasSubstr("includes the source apps/b.cpp")));
}

}  // namespace
