#include "dkp_slam/evaluation/report/html.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/evaluation/canvas.h"

namespace dkp_slam {
namespace {

constexpr const char* style = R"css(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #f4f6f8; color: #24292f;
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 32px 64px; background: #fff;
  box-shadow: 0 0 24px rgba(20, 40, 60, .08); min-height: 100vh; }
h1 { font-size: 28px; line-height: 1.2; margin: 6px 0 10px; }
h2 { font-size: 20px; margin: 40px 0 8px; padding-top: 14px; border-top: 1px solid #e3e8ed; }
p { margin: 8px 0; max-width: 84ch; }
p.lead { font-size: 17px; color: #47525d; }
p.warning { background: #fff6e0; border-left: 4px solid #e0a520; padding: 8px 12px; }
nav { font-size: 14px; margin: 14px 0; }
nav a { margin-right: 16px; color: #1f6ebe; text-decoration: none; }
.scroll { overflow-x: auto; margin: 12px 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 14px; }
th, td { padding: 5px 10px; text-align: right; border-bottom: 1px solid #e8ecf0; white-space: nowrap;
  vertical-align: top; }
th { background: #eef2f6; font-weight: 600; position: sticky; top: 0; }
th.l, td.l { text-align: left; }
td.wrap { white-space: normal; }
tr.ours td { background: #eaf3fc; font-weight: 600; }
tr.published td { color: #59636e; }
td small { display: block; font-weight: 400; color: #76818c; font-size: 11.5px; line-height: 1.2; }
figure { margin: 16px 0 26px; }
figure .row { display: flex; flex-wrap: wrap; gap: 12px; }
figure .row > * { flex: 1 1 300px; min-width: 0; max-width: 100%; height: auto; }
figure .row > svg { flex-basis: 440px; max-width: 540px; }
h3 { font-size: 16px; margin: 24px 0 4px; }
figure img { border-radius: 6px; display: block; }
figcaption { color: #59636e; font-size: 13.5px; margin-top: 6px; }
.cards { display: flex; flex-wrap: wrap; gap: 14px; margin: 18px 0; }
.card { flex: 1 1 180px; border: 1px solid #dfe5ea; border-radius: 10px; padding: 12px 16px; }
.card b { display: block; font-size: 26px; line-height: 1.2; }
.card span { color: #59636e; font-size: 13.5px; }
footer { margin-top: 44px; color: #76818c; font-size: 13px; }
@media print { body { background: #fff; } main { box-shadow: none; } }
)css";

std::string cell_html(const HtmlCell& cell, bool left_aligned, const char* tag) {
  // A long remark may be broken into lines; a name or a number may not.
  constexpr std::size_t long_text = 60;
  std::string names = left_aligned ? "l" : "";
  if (cell.text.size() > long_text) names += names.empty() ? "wrap" : " wrap";
  return fmt::format("<{0}{1}>{2}{3}</{0}>", tag,
                     names.empty() ? "" : fmt::format(" class=\"{}\"", names), escaped(cell.text),
                     cell.note.empty() ? "" : fmt::format("<small>{}</small>", escaped(cell.note)));
}

}  // namespace

HtmlTable::HtmlTable(std::vector<std::string> header, std::size_t left_columns)
    : columns_(header.size()), left_columns_(left_columns) {
  const bool named =
      std::any_of(header.begin(), header.end(), [](const auto& h) { return !h.empty(); });
  for (std::size_t i = 0; named && i < header.size(); ++i) {
    head_ += cell_html(header[i], i < left_columns_, "th");
  }
}

void HtmlTable::add(const std::vector<HtmlCell>& cells, HtmlRow kind) {
  rows_ += kind == HtmlRow::ours        ? "<tr class=\"ours\">"
           : kind == HtmlRow::published ? "<tr class=\"published\">"
                                        : "<tr>";
  for (std::size_t i = 0; i < columns_; ++i) {
    rows_ += cell_html(i < cells.size() ? cells[i] : HtmlCell(), i < left_columns_, "td");
  }
  rows_ += "</tr>\n";
}

std::string HtmlTable::text() const {
  const std::string head = head_.empty() ? "" : fmt::format("<thead><tr>{}</tr></thead>\n", head_);
  return fmt::format("<div class=\"scroll\"><table>\n{}<tbody>\n{}</tbody>\n</table></div>\n", head,
                     rows_);
}

std::string html_heading(const std::string& text, const std::string& anchor) {
  return fmt::format("<h2 id=\"{}\">{}</h2>\n", escaped(anchor), escaped(text));
}

std::string html_paragraph(const std::string& text) {
  return fmt::format("<p>{}</p>\n", escaped(text));
}

std::string html_figure(const std::vector<std::string>& pictures, const std::string& caption) {
  std::string row;
  for (const std::string& picture : pictures) row += picture;
  return fmt::format(
      "<figure>\n<div class=\"row\">{}</div>\n<figcaption>{}</figcaption>\n</figure>\n", row,
      escaped(caption));
}

std::string html_image(const std::string& address, const std::string& alternative) {
  return fmt::format("<img src=\"{}\" alt=\"{}\"/>", escaped(address), escaped(alternative));
}

std::string html_page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</"
      "html>\n",
      escaped(title), style, body);
}

}  // namespace dkp_slam
