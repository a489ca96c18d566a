#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace dkp_slam::sqlite {

/// How a database is opened.
enum class Access {
  /// As `exclusive`, and makes the file where there is none.
  create,
  /// Reads and writes, and keeps every other process out until it is closed.
  exclusive,
  /// Reads what is committed, in the file and in the log beside it; changes neither of them, and
  /// keeps every other process out until it is closed.
  read_with_log,
  /// Reads a file that has no log beside it. Takes no lock and leaves no trace, so that it works
  /// where nothing may be written; that nobody wrote meanwhile is the caller's to find out.
  read_alone,
};

/// One connection to an SQLite file in WAL mode. One thread at a time. All members throw `Error`,
/// which names the file and a remedy.
class Database {
 public:
  Database(const std::filesystem::path& file, Access access);

  /// One or several statements without result.
  void run(const char* sql);
  /// Moves everything from the log into the file.
  void checkpoint();
  /// Throws when there is no longer this file under its name: it was deleted, moved or replaced,
  /// and what is written reaches nobody.
  void check_in_place() const;
  /// For errors, what was asked being `what`.
  [[noreturn]] void fail(int code, std::string_view what) const;
  const std::filesystem::path& file() const { return file_; }
  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A prepared statement. Parameters count from 1, columns from 0, as in SQLite's own interface.
class Statement {
 public:
  Statement(Database& database, const char* sql);

  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, int value) { return bind(parameter, std::int64_t{value}); }
  Statement& bind(int parameter, double value);
  Statement& bind(int parameter, std::string_view text);
  Statement& bind_null(int parameter);
  /// The elements' bytes as they lie in memory. They must live until `execute`.
  template <class T>
  Statement& bind_blob(int parameter, std::span<const T> values) {
    return bind_bytes(parameter, std::as_bytes(values));
  }

  /// Runs a statement without result; it can be bound and run again then.
  void execute();
  /// The next row of the result; false at the end.
  bool step();

  /// Columns of the present row. All throw `Error` where the value is of another type.
  std::int64_t integer(int column) const;
  /// Also where it does not fit.
  int small_integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  bool null(int column) const;
  std::span<const std::byte> blob(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement& bind_bytes(int parameter, std::span<const std::byte> bytes);
  std::string name(int column) const;
  void check_type(int column, int type) const;

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// Several statements that take effect together or not at all; undone unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

/// What an `Error` says of a file whose content cannot be right.
[[noreturn]] void throw_damaged(const std::filesystem::path& file, std::string_view what);

}  // namespace dkp_slam::sqlite
