#include "dkp_slam/map_file/sqlite.h"

#include <limits>

#include <fmt/format.h>
#include <sqlite3.h>

#include "dkp_slam/error.h"

namespace dkp_slam::sqlite {
namespace fs = std::filesystem;
namespace {

constexpr int patience_ms = 2000;  // for a process that only looks into the file

/// The path as an SQLite URI, every character that might mean something there escaped.
std::string uri_of(const fs::path& file, std::string_view query) {
  std::string uri = "file:";
  for (const char c : fs::absolute(file).string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '.' || c == '_' || c == '-';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri.append(query);
}

const char* remedy(int code) {
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another process has it in use; end that one first";
    case SQLITE_FULL:
      return "the disk is full; make room, what was saved before is kept";
    case SQLITE_NOMEM:
      return "end other programs or raise the limit (ulimit -v); what was saved before is kept";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
    case SQLITE_CANTOPEN:
      return "check the rights of the file and its folder";
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return "the file is damaged; take a copy from before, or another file";
    default:
      return "check the disk; what was saved before is kept";
  }
}

}  // namespace

void throw_damaged(const fs::path& file, std::string_view what) {
  throw Error(fmt::format("{}: damaged map file: {}; take a copy from before, or another file",
                          file.string(), what));
}

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }

Database::Database(const fs::path& file, Access access) : file_(file) {
  const bool alone = access == Access::read_alone;
  int flags = SQLITE_OPEN_URI | (alone ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE);
  if (access == Access::create) flags |= SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int code =
      sqlite3_open_v2(uri_of(file, alone ? "?immutable=1" : "").c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail(code, "cannot be opened");
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, patience_ms);
  if (alone) return;
  if (sqlite3_db_readonly(handle, "main") != 0) fail(SQLITE_READONLY, "cannot be written");
  // With this the log's index lies in memory and no third file appears.
  run("PRAGMA locking_mode = EXCLUSIVE");
  if (access == Access::read_with_log) {
    sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    run("PRAGMA query_only = ON");
  } else {
    run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL");
  }
}

void Database::fail(int code, std::string_view what) const {
  const char* reason = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
  throw Error(fmt::format("{}: {} ({}): {}", file_.string(), what, reason, remedy(code)));
}

void Database::run(const char* sql) {
  const int code = sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code, "cannot be used");
}

void Database::checkpoint() {
  const int code =
      sqlite3_wal_checkpoint_v2(handle(), nullptr, SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code, "cannot be completed");
}

void Database::check_in_place() const {
  int moved = 0;
  const int code = sqlite3_file_control(handle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  if (code == SQLITE_OK && moved != 0) {
    throw Error(
        fmt::format("{}: was deleted, moved or replaced while it was written; give another "
                    "name, and leave the file alone",
                    file_.string()));
  }
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(Database& database, const char* sql) : database_(database) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(database.handle(), sql, -1, &statement, nullptr);
  statement_.reset(statement);
  // An SQL error can only mean that a table is not as this program made it.
  if (code == SQLITE_ERROR) throw_damaged(database.file(), sqlite3_errmsg(database.handle()));
  if (code != SQLITE_OK) database.fail(code, "cannot be read");
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter, value);
  return *this;
}

Statement& Statement::bind(int parameter, double value) {
  sqlite3_bind_double(statement_.get(), parameter, value);
  return *this;
}

Statement& Statement::bind(int parameter, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}

Statement& Statement::bind_null(int parameter) {
  sqlite3_bind_null(statement_.get(), parameter);
  return *this;
}

Statement& Statement::bind_bytes(int parameter, std::span<const std::byte> bytes) {
  // An empty span has no address, which SQLite would take for NULL.
  const void* data = bytes.empty() ? static_cast<const void*>("") : bytes.data();
  sqlite3_bind_blob64(statement_.get(), parameter, data, bytes.size(), SQLITE_STATIC);
  return *this;
}

void Statement::execute() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_DONE) database_.fail(code, "cannot be written");
  sqlite3_reset(statement_.get());
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail(code, "cannot be read");
  return code == SQLITE_ROW;
}

std::string Statement::name(int column) const {
  const char* name = sqlite3_column_name(statement_.get(), column);
  return name ? fmt::format("column {}", name) : "a column that is missing";
}

void Statement::check_type(int column, int type) const {
  if (sqlite3_column_type(statement_.get(), column) == type) return;
  throw_damaged(database_.file(), fmt::format("{} holds a value of the wrong type", name(column)));
}

std::int64_t Statement::integer(int column) const {
  check_type(column, SQLITE_INTEGER);
  return sqlite3_column_int64(statement_.get(), column);
}

int Statement::small_integer(int column) const {
  const std::int64_t value = integer(column);
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    throw_damaged(database_.file(), fmt::format("{} holds {}", name(column), value));
  }
  return static_cast<int>(value);
}

double Statement::real(int column) const {
  check_type(column, SQLITE_FLOAT);  // NaN is stored as NULL
  return sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  check_type(column, SQLITE_TEXT);
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

bool Statement::null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::span<const std::byte> Statement::blob(int column) const {
  check_type(column, SQLITE_BLOB);
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace dkp_slam::sqlite
