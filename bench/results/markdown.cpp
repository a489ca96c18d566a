#include "bench/results/markdown.h"

#include <algorithm>

#include <fmt/format.h>

namespace dkp_slam::bench {
namespace {

std::string as_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

}  // namespace

MarkdownTable::MarkdownTable(std::vector<std::string> header, std::size_t left_columns)
    : left_columns_(left_columns) {
  rows_.push_back(std::move(header));
}

void MarkdownTable::add(std::vector<std::string> cells) {
  cells.resize(rows_.front().size());
  std::transform(cells.begin(), cells.end(), cells.begin(), as_cell);
  rows_.push_back(std::move(cells));
}

std::string MarkdownTable::text() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 3);  // what the rule below the header takes at least
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < columns; ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string out;
  for (const auto& row : rows_) {
    const bool header = &row == &rows_.front();
    std::string rule;
    for (std::size_t c = 0; c < columns; ++c) {
      const bool left = c < left_columns_;
      out += left ? fmt::format("| {:<{}} ", row[c], widths[c])
                  : fmt::format("| {:>{}} ", row[c], widths[c]);
      rule += fmt::format("|{:-<{}}{}", "", widths[c] + 1, left ? '-' : ':');
    }
    out += "|\n";
    if (header) out += rule + "|\n";
  }
  return out;
}

std::string number(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100.0 * *share) : "-";
}

}  // namespace dkp_slam::bench
