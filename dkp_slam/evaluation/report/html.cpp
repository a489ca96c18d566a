#include "dkp_slam/evaluation/report/html.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "dkp_slam/embedded_file.h"
#include "dkp_slam/evaluation/canvas.h"

// Built by scripts/build_page.sh from viewer/page/report.
DKP_SLAM_EMBED_FILE(report_script, DKP_SLAM_REPORT_PAGE_FOLDER "/report.js");
DKP_SLAM_EMBED_FILE(report_style, DKP_SLAM_REPORT_PAGE_FOLDER "/report.css");

namespace dkp_slam {
namespace {

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
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src &#39;none&#39;; "
      "script-src &#39;unsafe-inline&#39;; style-src &#39;unsafe-inline&#39;; img-src data:\"/>\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}"
      "<noscript><p class=\"warning\">The charts need JavaScript, which is switched off "
      "here.</p></noscript>\n</main>\n<script>{}</script>\n</body>\n</html>\n",
      escaped(title), DKP_SLAM_EMBEDDED(report_style), body, DKP_SLAM_EMBEDDED(report_script));
}

}  // namespace dkp_slam
