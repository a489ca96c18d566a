#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dkp_slam::bench {

/// A table in Markdown, padded so that it reads well as plain text too.
class MarkdownTable {
 public:
  /// At least one column; the first `left_columns` are aligned to the left, the others, numbers, to
  /// the right.
  explicit MarkdownTable(std::vector<std::string> header, std::size_t left_columns = 1);

  /// A row with as many cells as the header; missing ones are left empty. A '|' in a cell is
  /// escaped, a line break becomes a blank.
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.size() == 1; }

  /// Ends with a line break.
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
  std::size_t left_columns_;
};

/// With this many decimals; "-" where there is no value.
std::string number(const std::optional<double>& value, int decimals);
/// A share as a percentage with one decimal: 0.983 is "98.3 %".
std::string percent(const std::optional<double>& share);

}  // namespace dkp_slam::bench
