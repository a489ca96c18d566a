// Map files byte by byte, with a log beside them or none. Reading changes neither.
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_writer.h"
#include "fuzz/target.h"
#include "tests/support/file_text.h"

namespace dkp_slam::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with the program.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("fuzz." + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path file() const { return path_ / "a.map"; }
  fs::path log() const { return path_ / "a.map-wal"; }

 private:
  fs::path path_;
};

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

struct Written {
  std::string file, log;
};

/// A map that a process was killed while it wrote.
Written killed_in_mid_run(const Folder& folder) {
  testing::GrowingMap grown(20);
  MapWriter writer(folder.file(), grown.map);
  writer.update(grown.map);
  grown.grow_to(4);
  writer.update(grown.map);
  return {testing::content(folder.file()), testing::content(folder.log())};
}

/// Most of a file is pages that no mutation has to invent: the input says what to change in a good
/// one, as (place, byte) pairs, and where to cut it off.
void change(std::string& text, Reader& input) {
  if (text.empty()) return;
  const int changes = input.below(12);
  for (int i = 0; i < changes; ++i) {
    const std::size_t at = input.take<std::uint32_t>() % text.size();
    text[at] = input.take<char>();
  }
  if (input.below(8) == 1) text.resize(input.take<std::uint32_t>() % text.size());
}

void run(Bytes bytes) {
  static const Folder folder;
  static const Written good = killed_in_mid_run(folder);
  Reader input(bytes);
  const int kind = input.below(4);
  Written now;
  if (kind == 0) {
    now.file = text_of(input.rest());
  } else {
    now = good;
    change(now.file, input);
    change(now.log, input);
    if (kind == 1) now.log.clear();
  }
  fs::remove(folder.file());
  write(folder.file(), now.file);
  fs::remove(folder.log());
  if (!now.log.empty()) write(folder.log(), now.log);
  takes([&] {
    const StoredMap stored = read_map(folder.file());
    require(!parts_of(stored.map).check(), "a map that was read and is none");
  });
  require(testing::content(folder.file()) == now.file, "reading changed the file");
  require(testing::content(folder.log()) == now.log, "reading changed the log");
}

std::vector<std::string> seeds() {
  return {std::string("\2\0\0\0\0", 5), std::string("\1\0\0\0\0", 5),
          std::string("\2\2\144\0\0\0\7\30\0\0\0\1\0\1\50\0\0\0\5\0", 20), "\0SQLite format 3"};
}

const Registration registration({"map_file", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
