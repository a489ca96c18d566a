#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace dkp_slam::testing {

/// Strict check of XML (and of pages written so): every tag closed in order, every attribute quoted
/// and named once, every & an entity; a script is as long as a browser takes it to be. Says the
/// first thing that is wrong; empty when nothing is.
class MarkupCheck {
 public:
  explicit MarkupCheck(const std::string& text) : text_(text) {}

  std::string problem() {
    while (at_ < text_.size()) {
      const bool good = text_[at_] == '<' ? tag() : character();
      if (!good) return wrong_ + " at: " + text_.substr(at_, 60);
    }
    return open_.empty() ? "" : "never closed: " + open_.back();
  }
  /// How many elements of this name there are.
  std::size_t count(const std::string& name) const {
    std::size_t n = 0;
    for (const std::string& tag : seen_) n += tag == name ? 1 : 0;
    return n;
  }

 private:
  bool fail(const std::string& what) {
    wrong_ = what;
    return false;
  }
  bool character() {
    if (text_[at_] == '&') {
      const std::size_t end = text_.find(';', at_);
      if (end == std::string::npos) return fail("stray &");
      const std::string entity = text_.substr(at_ + 1, end - at_ - 1);
      const bool known = entity == "amp" || entity == "lt" || entity == "gt" || entity == "quot" ||
                         (entity.size() > 1 && entity[0] == '#');
      if (!known) return fail("unknown entity");
    }
    const auto c = static_cast<unsigned char>(text_[at_]);
    if (c < 0x20 && c != '\n' && c != '\t') return fail("control character");
    ++at_;
    return true;
  }
  static bool is_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == ':' || c == '_';
  }
  std::string name() {
    const std::size_t start = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }
  bool tag() {
    if (text_.compare(at_, 9, "<!DOCTYPE") == 0) {
      at_ = text_.find('>', at_) + 1;
      return true;
    }
    ++at_;
    const bool closing = text_[at_] == '/';
    if (closing) ++at_;
    const std::string tag = name();
    if (tag.empty()) return fail("tag without a name");
    if (closing) {
      if (open_.empty() || open_.back() != tag) return fail("closes what is not open: " + tag);
      open_.pop_back();
      return end_with(">");
    }
    seen_.push_back(tag);
    if (!attributes()) return false;
    if (text_[at_] == '/') {
      ++at_;
      return end_with(">");
    }
    open_.push_back(tag);
    if (!end_with(">")) return false;
    if (tag == "script") at_ = std::min(text_.find("</script", at_), text_.size());
    return true;
  }
  bool attributes() {
    std::vector<std::string> names;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) {
      ++at_;
      if (!is_name(text_[at_])) continue;
      const std::string attribute = name();
      for (const std::string& other : names) {
        if (other == attribute) return fail("attribute twice: " + attribute);
      }
      names.push_back(attribute);
      if (!end_with("=") || !end_with("\"")) return fail("attribute without quotes: " + attribute);
      while (at_ < text_.size() && text_[at_] != '"') {
        if (text_[at_] == '<') return fail("< in an attribute");
        if (!character()) return false;
      }
      if (!end_with("\"")) return false;
    }
    return true;
  }
  bool end_with(const char* expected) {
    if (at_ >= text_.size() || text_[at_] != expected[0]) {
      return fail(std::string("expected ") + expected);
    }
    ++at_;
    return true;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::vector<std::string> open_, seen_;
  std::string wrong_;
};

/// The data of the charts of a page, in their order.
inline std::vector<nlohmann::json> charts_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\">";
  std::vector<nlohmann::json> charts;
  for (auto at = page.find(begin); at != std::string::npos; at = page.find(begin, at + 1)) {
    const std::size_t start = at + begin.size();
    charts.push_back(
        nlohmann::json::parse(page.substr(start, page.find("</script>", start) - start)));
  }
  return charts;
}

/// How many times `part` stands in `text`.
inline std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace dkp_slam::testing
