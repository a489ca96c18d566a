#include "dkp_slam/map_file/map_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dkp_slam/error.h"
#include "dkp_slam/map_file/map_rows.h"
#include "dkp_slam/map_file/sqlite.h"

namespace dkp_slam {
namespace fs = std::filesystem;
namespace {

template <class... Values>
[[noreturn]] void fail(const fs::path& file, fmt::format_string<Values...> format,
                       Values&&... values) {
  throw Error(file.string() + ": " + fmt::format(format, std::forward<Values>(values)...));
}

// The header of an SQLite file, see https://www.sqlite.org/fileformat.html section 1.3.
constexpr std::size_t header_size = 100;
constexpr std::string_view magic("SQLite format 3\0", 16);
using Header = std::array<unsigned char, header_size>;

std::uint32_t big_endian(const Header& header, std::size_t at, std::size_t bytes = 4) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | header[at + i];
  return value;
}

/// Bytes that the file must have according to its header; 0 where that does not say.
std::uintmax_t promised_size(const Header& header) {
  if (big_endian(header, 24) != big_endian(header, 92)) return 0;
  std::uintmax_t page = big_endian(header, 16, 2);
  if (page == 1) page = 65536;
  return page * big_endian(header, 28);
}

fs::path log_of(const fs::path& file) {
  // SQLite keeps the log beside the file itself, not beside a link to it.
  std::error_code error;
  fs::path real = fs::canonical(file, error);
  if (error) real = file;
  return real += "-wal";
}

/// Without changing the file's place or contents in between, its time of change stays the same.
struct Fingerprint {
  struct stat status {};
  bool log = false;

  explicit Fingerprint(const fs::path& file) : log(fs::exists(log_of(file))) {
    if (::stat(file.c_str(), &status) != 0) fail(file, "cannot be read: {}", std::strerror(errno));
  }
  bool operator==(const Fingerprint& other) const {
    return log == other.log && status.st_ino == other.status.st_ino &&
           status.st_size == other.status.st_size &&
           status.st_mtim.tv_sec == other.status.st_mtim.tv_sec &&
           status.st_mtim.tv_nsec == other.status.st_mtim.tv_nsec;
  }
};

StoredMap read_from(sqlite::Database& database) {
  const fs::path& file = database.file();
  {
    sqlite::Statement check(database, "PRAGMA quick_check(1)");
    const std::string verdict = check.step() ? check.text(0) : "no answer";
    if (verdict != "ok") sqlite::throw_damaged(file, verdict.substr(0, verdict.find('\n')));
  }
  MapParts parts = read_parts(database);
  if (const auto reason = parts.check()) sqlite::throw_damaged(file, *reason);
  StoredMap stored{file, Map(std::move(parts)), {}, map_program_version(database), 0};
  stored.state.revision = map_revision(database);
  stored.state.finder.find(stored.map);
  stored.bytes = fs::file_size(file);
  if (fs::exists(log_of(file))) stored.bytes += fs::file_size(log_of(file));
  return stored;
}

void check_place_for_new(const fs::path& file) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(file, error)))
    fail(file, "is there already; choose another name");
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    fail(file, "cannot be made: the folder {} does not exist; make it first", folder.string());
}

/// Makes a map file under another name, which `fill` may write to, then gives it its own.
void make_file(const fs::path& file, const Map& map,
               const std::function<void(sqlite::Database&)>& fill) {
  check_place_for_new(file);
  fs::path temporary = file;
  temporary += fmt::format(".{}.tmp", ::getpid());
  fs::path temporary_log = temporary;
  temporary_log += "-wal";
  std::error_code ignored;
  fs::remove(temporary, ignored);
  fs::remove(temporary_log, ignored);
  try {
    {
      sqlite::Database database(temporary, sqlite::Access::create);
      create_map_tables(database, map.camera(), map.level_scale(), map.levels());
      fill(database);
      database.checkpoint();
    }
    // Unlike a renaming, a link never takes another file's place.
    std::error_code error;
    fs::create_hard_link(temporary, file, error);
    if (error == std::errc::file_exists) fail(file, "is there already; choose another name");
    if (error) fs::rename(temporary, file);  // a file system without links
    fs::remove(temporary, ignored);
  } catch (const std::exception& error) {
    fs::remove(temporary, ignored);
    fs::remove(temporary_log, ignored);
    // Of the name in between nobody needs to know.
    std::string message = error.what();
    if (message.starts_with(temporary.string()))
      message.replace(0, temporary.string().size(), file.string());
    throw Error(message);
  }
}

}  // namespace

void check_map_header(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) fail(file, "no such map file; check the name");
  if (fs::is_directory(status)) fail(file, "is a folder; give a map file");
  if (!fs::is_regular_file(status)) fail(file, "is no regular file; give a map file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "cannot be opened; check its rights");
  Header header{};
  stream.read(reinterpret_cast<char*>(header.data()), header_size);
  const auto size = static_cast<std::size_t>(stream.gcount());
  if (stream.bad()) fail(file, "cannot be read; check the disk");
  if (size == 0) fail(file, "is empty, no map; delete it or choose another name");
  const std::size_t compared = std::min(size, magic.size());
  if (std::memcmp(header.data(), magic.data(), compared) != 0)
    fail(file, "is no map file of dkp-slam; choose another name");
  if (size < header_size) fail(file, "is cut off after {} bytes; take a copy from before", size);
  if (big_endian(header, 68) != map_application_id)
    fail(file, "is another program's database, no map; choose another name");
  const std::uint32_t version = big_endian(header, 60);
  if (version != map_format_version) {
    fail(file,
         "is a map of format {}, this program reads format {} only; use the {} dkp-slam that "
         "wrote it or start another file",
         version, +map_format_version, version > map_format_version ? "newer" : "older");
  }
  // While there is a log, the file's end may still be in it.
  const std::uintmax_t promised = promised_size(header);
  if (fs::file_size(file) < promised && !fs::exists(log_of(file))) {
    fail(file, "is cut off: {} of {} bytes; take a copy from before", fs::file_size(file),
         promised);
  }
}

StoredMap read_map(const fs::path& file) {
  check_map_header(file);
  const Fingerprint before(file);
  if (before.log) {
    if (::access(file.c_str(), W_OK) != 0) {
      fail(file,
           "was not closed (there is {}), and its rights do not let it be locked; make it "
           "writable",
           log_of(file).string());
    }
    sqlite::Database database(file, sqlite::Access::read_with_log);
    return read_from(database);
  }
  std::optional<StoredMap> stored;
  std::string problem;
  try {
    sqlite::Database database(file, sqlite::Access::read_alone);
    stored.emplace(read_from(database));
  } catch (const Error& error) {
    problem = error.what();
  }
  if (!(Fingerprint(file) == before))
    fail(file, "another process has it in use; end that one first");
  if (!stored) throw Error(problem);
  return std::move(*stored);
}

void check_fits(const StoredMap& stored, const Camera& camera, float level_scale, int levels) {
  std::optional<std::string> difference = difference_of(stored.map.camera(), camera);
  if (!difference && (stored.map.level_scale() != level_scale || stored.map.levels() != levels)) {
    difference = fmt::format("{} pyramid levels {:.3f} apart there, {} levels {:.3f} apart here",
                             stored.map.levels(), stored.map.level_scale(), levels, level_scale);
  }
  if (!difference) return;
  fail(stored.file, "is a map made with another camera: {}; give that camera's file or another map",
       *difference);
}

void save_map(const fs::path& file, const Map& map) {
  make_file(file, map,
            [&](sqlite::Database& database) { write_change(database, ChangeFinder().find(map)); });
}

void create_map_file(const fs::path& file, const Map& map) {
  make_file(file, map, [](sqlite::Database&) {});
}

}  // namespace dkp_slam
