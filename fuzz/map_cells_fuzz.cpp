// Tables of a map file with other values in some of their cells: what is read without complaint is
// a map that everything can be done with, and that the writer does not refuse.
#include <filesystem>

#include <unistd.h>

#include "dkp_slam/map/map_snapshot.h"
#include "dkp_slam/map/test_map.h"
#include "dkp_slam/map_file/map_file.h"
#include "dkp_slam/map_file/map_rows.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

using sqlite::Database;
using sqlite::Statement;

/// A good map file, open, of which changes are undone.
class MapTables {
 public:
  MapTables() : file_("fuzz." + std::to_string(getpid()) + ".map") {
    testing::GrowingMap grown(20);
    grown.grow_to(8);
    file_ = std::filesystem::temp_directory_path() / file_;
    remove();
    save_map(file_, grown.map);
    database_ = std::make_unique<Database>(file_, sqlite::Access::exclusive);
  }
  ~MapTables() {
    database_.reset();
    remove();
  }
  Database& database() { return *database_; }

 private:
  void remove() const {
    for (const char* suffix : {"", "-wal"}) {
      std::error_code ignored;
      std::filesystem::remove(file_.string() + suffix, ignored);
    }
  }
  std::filesystem::path file_;
  std::unique_ptr<Database> database_;
};

struct Column {
  const char* table;
  const char* name;
};
constexpr Column columns[] = {{"meta", "value"},
                              {"maps", "id"},
                              {"keyframes", "id"},
                              {"keyframes", "map"},
                              {"keyframes", "timestamp"},
                              {"keyframes", "qw"},
                              {"keyframes", "tx"},
                              {"keyframes", "parent"},
                              {"keyframes", "landmarks"},
                              {"features", "keyframe"},
                              {"features", "pixel"},
                              {"features", "depth"},
                              {"features", "level"},
                              {"features", "angle"},
                              {"features", "descriptor"},
                              {"landmarks", "id"},
                              {"landmarks", "x"},
                              {"landmarks", "first_keyframe"},
                              {"landmarks", "visible"},
                              {"landmarks", "found"},
                              {"landmarks", "dynamic_log_odds"}};

void bind_value(Statement& statement, Reader& input) {
  switch (input.below(6)) {
    case 0:
      statement.bind(1, input.take<std::int64_t>());
      return;
    case 1:
      statement.bind(1, std::int64_t{input.take<std::int8_t>()});
      return;
    case 2:
      statement.bind(1, input.take<double>());
      return;
    case 3:
      statement.bind_null(1);
      return;
    default: {
      const auto length = std::min(input.take<std::uint8_t>(), static_cast<std::uint8_t>(200));
      std::string value;
      for (int i = 0; i < length; ++i) value += input.take<char>();
      statement.bind(1, std::string_view(value));
    }
  }
}

/// Sets a cell to a value, or some bytes of a list in it, or deletes its row.
void change_cell(Database& database, Reader& input) {
  const Column& column = columns[input.below(std::size(columns))];
  const int row = input.below(160), kind = input.below(8);
  const std::string here =
      fmt::format(" WHERE rowid = (SELECT rowid FROM {} LIMIT 1 OFFSET {})", column.table, row);
  const std::string keyed =
      fmt::format(" WHERE key = (SELECT key FROM meta LIMIT 1 OFFSET {})", row % 7);
  const std::string& where = std::string_view(column.table) == "meta" ? keyed : here;
  if (kind == 0) {
    database.run(fmt::format("DELETE FROM {}{}", column.table, where).c_str());
    return;
  }
  if (kind < 4) {  // a piece of what is there, in its type
    const int at = 1 + input.take<std::uint16_t>() % 800;
    const std::string sql = fmt::format(
        "UPDATE OR IGNORE {0} SET {1} = CAST(substr({1}, 1, {2}) || ? || substr({1}, {3}) AS "
        "BLOB){4}",
        column.table, column.name, at - 1, at + 4, where);
    Statement statement(database, sql.c_str());
    const auto piece = input.take<std::array<std::byte, 4>>();
    statement.bind_blob(1, std::span<const std::byte>(piece)).execute();
    return;
  }
  Statement statement(
      database,
      fmt::format("UPDATE OR IGNORE {} SET {} = ?{}", column.table, column.name, where).c_str());
  bind_value(statement, input);
  statement.execute();
}

void use(const MapParts& parts) {
  require(!parts.check(), "a map that was read and is none");
  Map map(parts);
  for (const int id : map.landmarks()) {
    map.refresh(id);
    map.predicted_level(map.landmark(id), 2.0);
  }
  for (int k = 0; k < map.keyframe_ids(); ++k) {
    if (map.keyframe(k).features.size() > 0) map.best_covisible(k, 5);
    if (k > 1000) break;
  }
  require(testing::difference(parts, parts_of(map)).empty(), "a map that is not its parts");
  const MapParts two = merged(parts, parts);
  // Where its ids would go beyond what can be read, merging is refused by the same check.
  if (!problem_of_counts(two.keyframe_ids, two.landmark_ids, two.maps, two.current_map)) {
    require(!two.check(), "two good maps make a bad one");
  }
}

void run(Bytes bytes) {
  static MapTables tables;
  Reader input(bytes);
  const sqlite::Transaction undone(tables.database());
  takes([&] {
    for (int i = 0; i < 8 && !input.empty(); ++i) change_cell(tables.database(), input);
    const MapParts parts = read_parts(tables.database());
    if (!parts.check()) use(parts);
  });
}

std::vector<std::string> seeds() {
  std::vector<std::string> all{""};
  for (std::size_t column = 0; column < std::size(columns); ++column) {
    for (const int kind : {1, 5}) {
      all.push_back({static_cast<char>(column), 2, static_cast<char>(kind), 1, 0, 3, 0, 0, 0});
    }
  }
  return all;
}

const Registration registration({"map_cells", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
