#include "dkp_slam/config/option_list.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "dkp_slam/error.h"

namespace dkp_slam {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

template <class Number>
std::optional<Number> number_of(const std::string& text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) return std::nullopt;
  if (!std::isfinite(static_cast<double>(number))) return std::nullopt;
  return number;
}

/// As a number, where it is one.
std::optional<double> number_in(const Option& option) {
  return std::visit(
      [](const auto& value) -> std::optional<double> {
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_pointer_v<Value>) {
          using Number = std::remove_pointer_t<Value>;
          if constexpr (std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>) {
            return static_cast<double>(*value);
          }
        }
        return std::nullopt;
      },
      option.value);
}

/// Letters to put in, take out or change (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t before = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = before + (a[i] != b[j]);
      before = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, before + 1, change});
    }
  }
  return row.back();
}

std::string_view last_part(std::string_view name) { return name.substr(name.rfind('.') + 1); }

}  // namespace

std::string Bounds::text() const {
  const bool below = std::isfinite(lower), over = std::isfinite(upper);
  if (below && over && !without_lower && !without_upper) {
    return fmt::format("from {} to {}", lower, upper);
  }
  std::string text;
  if (below) text = fmt::format("{} {}", without_lower ? "above" : "at least", lower);
  if (over) {
    text +=
        fmt::format("{}{} {}", below ? " and " : "", without_upper ? "below" : "at most", upper);
  }
  return text;
}

std::string Option::text() const {
  return std::visit(Overloaded{[](const Choice& choice) {
                                 const std::size_t i = choice.get();
                                 return i < choice.names.size() ? choice.names[i] : choice.other();
                               },
                               [](const std::string* value) { return *value; },
                               [](const std::filesystem::path* value) { return value->string(); },
                               [](const auto* value) { return fmt::format("{}", *value); }},
                    value);
}

std::string Option::wanted() const {
  const std::string range = bounds.text().empty() ? "" : fmt::format(" {}", bounds.text());
  return std::visit(
      Overloaded{[](const Choice& choice) {
                   return fmt::format("one of {}", fmt::join(choice.names, ", "));
                 },
                 [](const bool*) { return std::string("true or false"); },
                 [](const std::string*) { return std::string("a text"); },
                 [](const std::filesystem::path*) { return std::string("a file's path"); },
                 [&](const int*) { return "a whole number" + range; },
                 [&](const std::uint64_t*) { return "a whole number" + range; },
                 [&](const auto*) { return "a number" + range; }},
      value);
}

void Option::assign(const std::string& text) {
  const auto refuse = [&] {
    throw Error(fmt::format("{} is '{}'; it must be {}", name, text, wanted()));
  };
  std::visit(Overloaded{[&](const Choice& choice) {
                          const auto known =
                              std::find(choice.names.begin(), choice.names.end(), text);
                          if (known == choice.names.end()) refuse();
                          choice.set(static_cast<std::size_t>(known - choice.names.begin()));
                        },
                        [&](bool* to) {
                          if (text != "true" && text != "false") refuse();
                          *to = text == "true";
                        },
                        [&](std::string* to) { *to = text; },
                        [&](std::filesystem::path* to) { *to = text; },
                        [&]<class Number>(Number* to) {
                          const auto number = number_of<Number>(text);
                          if (!number || !bounds.hold(static_cast<double>(*number))) refuse();
                          *to = *number;
                        }},
             value);
}

void Option::check() const {
  const bool good =
      std::visit(Overloaded{[](const Choice& choice) { return choice.get() < choice.names.size(); },
                            [&](const auto&) {
                              const auto number = number_in(*this);
                              return !number || (std::isfinite(*number) && bounds.hold(*number));
                            }},
                 value);
  if (!good) throw Error(fmt::format("{} is {}; it must be {}", name, text(), wanted()));
}

void OptionList::order(const char* smaller, const char* larger) {
  ordered_.emplace_back(path_ + smaller, path_ + larger);
}

Option* OptionList::find(std::string_view name) {
  const auto known = std::find_if(options_.begin(), options_.end(),
                                  [&](const Option& option) { return option.name == name; });
  return known == options_.end() ? nullptr : &*known;
}

std::string OptionList::nearest(std::string_view name) const {
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  const auto consider = [&](const std::string& known) {
    // The field alone counts as well: parts are left out, or taken for one another.
    const std::size_t distance =
        std::min(edit_distance(name, known), edit_distance(last_part(name), last_part(known)) + 1);
    if (distance >= least) return;
    least = distance;
    best = known;
  };
  for (const Option& option : options_) consider(option.name);
  for (const Part& part : parts_) consider(part.name);
  return best;
}

void OptionList::assign(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw Error(fmt::format("'{}' is no part.field=value", assignment));
  }
  const std::string name = assignment.substr(0, equals);
  if (Option* option = find(name)) return option->assign(assignment.substr(equals + 1));
  const bool part =
      std::any_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == name; });
  if (part) {
    throw Error(fmt::format("{} is a part and has no value; name one of its fields", name));
  }
  throw Error(fmt::format("there is no option {}; did you mean {}?", name, nearest(name)));
}

void OptionList::check() const {
  for (const Option& option : options_) option.check();
  const auto at = [&](const std::string& name) -> const Option& {
    return *std::find_if(options_.begin(), options_.end(),
                         [&](const Option& option) { return option.name == name; });
  };
  for (const auto& [smaller, larger] : ordered_) {
    const Option &low = at(smaller), &high = at(larger);
    if (number_in(low).value() <= number_in(high).value()) continue;
    throw Error(fmt::format("{} is {}; it must be at most {}, which is {}", smaller, low.text(),
                            larger, high.text()));
  }
}

void OptionList::expect_fields(std::size_t count) const {
  if (fields_ == count) return;
  throw std::logic_error(
      fmt::format("the options of '{}' list {} of {} fields", path_, fields_, count));
}

}  // namespace dkp_slam
