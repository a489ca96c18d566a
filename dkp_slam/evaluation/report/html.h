#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dkp_slam {

/// A cell of a table, plain text.
struct HtmlCell {
  HtmlCell() = default;
  HtmlCell(std::string t, std::string n = "") : text(std::move(t)), note(std::move(n)) {}
  HtmlCell(const char* t) : text(t) {}

  std::string text;
  std::string note;  ///< small, below the text
};

/// What a row is about; decides how it looks.
enum class HtmlRow { plain, ours, published };

/// A table of text in HTML. Everything is escaped.
class HtmlTable {
 public:
  /// The first `left_columns` are aligned to the left, the others, numbers, to the right.
  /// A header of empty names is not shown.
  explicit HtmlTable(std::vector<std::string> header, std::size_t left_columns = 1);

  /// A row with as many cells as the header; missing ones are left empty.
  void add(const std::vector<HtmlCell>& cells, HtmlRow kind = HtmlRow::plain);
  bool empty() const { return rows_.empty(); }
  std::string text() const;

 private:
  std::size_t columns_, left_columns_;
  std::string head_, rows_;
};

/// A heading with an anchor to link to.
std::string html_heading(const std::string& text, const std::string& anchor);
/// A paragraph; the text is escaped.
std::string html_paragraph(const std::string& text);
/// Pictures side by side, each of them a chart (page_charts.h) or as `html_image` made it, with a
/// line of text below.
std::string html_figure(const std::vector<std::string>& pictures, const std::string& caption);
/// A picture by its address, `data_uri`'s for one, and what is said where it cannot be seen.
std::string html_image(const std::string& address, const std::string& alternative);

/// A whole page with the script that draws its charts: one file that needs no other and no network,
/// which the page itself forbids. Every tag is closed. `title` is escaped, `body` is not.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace dkp_slam
