#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "dkp_slam/config/field_count.h"

namespace dkp_slam {

/// The numbers that an option may be.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool without_lower = false, without_upper = false;  ///< the bound itself is not allowed

  bool hold(double value) const {
    return (without_lower ? value > lower : value >= lower) &&
           (without_upper ? value < upper : value <= upper);
  }
  /// "at least 1", "above 0 and at most 1", "from 0 to 1"; empty where any number will do.
  std::string text() const;
};

constexpr Bounds any_number() { return {}; }
constexpr Bounds at_least(double lower) { return {.lower = lower}; }
constexpr Bounds above(double lower) { return {.lower = lower, .without_lower = true}; }
constexpr Bounds between(double lower, double upper) { return {.lower = lower, .upper = upper}; }
/// Above 0 and at most 1.
constexpr Bounds positive_share() { return {.lower = 0.0, .upper = 1.0, .without_lower = true}; }

/// An option that is one of a few names.
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;      ///< index into `names`
  std::function<void(std::size_t)> set;  ///< of an index into `names`
  std::function<std::string()> other;    ///< the value where it is none of the names
};

/// One field of an options struct: where it lies, and all that there is to say about it.
struct Option {
  std::string name;  ///< with the parts it lies in: "tracking.belief.moved"
  std::variant<bool*, int*, std::uint64_t*, float*, double*, std::string*, std::filesystem::path*,
               Choice>
      value;
  Bounds bounds;        ///< of a number
  std::string unit;     ///< "pixels"; empty where the meaning says it
  std::string meaning;  ///< a few words, for the comment in a configuration file

  /// The value as in a file: "40", "0.3" (as few digits as give the same number), "true", "dkp+".
  std::string text() const;
  /// What values it takes, to follow "it must be": "a whole number of at least 1".
  std::string wanted() const;
  /// Throws `Error` unless the text is of the option's type and within its bounds; the option is
  /// then as it was.
  void assign(const std::string& text);
  /// Throws `Error`, which names option, value and bound, when the value is out of bounds.
  void check() const;
};

/// The options of a struct and of the structs in it, each bound to its field. Made by the structs'
/// own `describe`, the only place where their fields are listed: checks, files, the command line
/// and the documentation all come from it. Holds as long as the struct stays where it is.
class OptionList {
 public:
  /// A struct is what lists its fields by a member `describe(OptionList&)`, each field once.
  /// Throws std::logic_error where it forgets one.
  template <class Options>
  static OptionList of(Options& options) {
    OptionList list;
    list.describe(options);
    return list;
  }

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void add(const char* name, Number& value, const Bounds& bounds, const char* unit,
           const char* meaning) {
    static_assert(!std::is_same_v<Number, bool>, "a bool has no bounds");
    append({path_ + name, &value, bounds, unit, meaning});
  }
  void add(const char* name, bool& value, const char* meaning) {
    append({path_ + name, &value, {}, "", meaning});
  }
  void add(const char* name, std::string& value, const char* meaning) {
    append({path_ + name, &value, {}, "", meaning});
  }
  void add(const char* name, std::filesystem::path& value, const char* meaning) {
    append({path_ + name, &value, {}, "", meaning});
  }
  /// An enumeration, or a text of which only some are allowed.
  template <class Value>
  void add(const char* name, Value& value,
           const std::type_identity_t<std::vector<std::pair<Value, std::string>>>& names,
           const char* meaning) {
    Choice choice;
    std::vector<Value> values;
    for (const auto& [v, text] : names) {
      values.push_back(v);
      choice.names.push_back(text);
    }
    choice.get = [&value, values] {
      std::size_t i = 0;
      while (i < values.size() && values[i] != value) ++i;
      return i;
    };
    choice.set = [&value, values](std::size_t i) { value = values.at(i); };
    choice.other = [&value] {
      if constexpr (std::is_enum_v<Value>) {
        return std::to_string(static_cast<long>(value));
      } else {
        return value;
      }
    };
    append({path_ + name, std::move(choice), {}, "", meaning});
  }
  /// A field that is itself a struct of options.
  template <class Part>
  void add_part(const char* name, Part& part, const char* meaning) {
    const std::string outer = path_;
    const std::size_t outer_fields = fields_;
    parts_.push_back({outer + name, meaning});
    path_ = outer + name + ".";
    describe(part);
    path_ = outer;
    fields_ = outer_fields + 1;
  }
  /// A field that is no option: it comes from a file of its own, or from the program.
  void leave_out() { ++fields_; }
  /// The option added last is a field of a part, which leaves it out, and not of this struct.
  void of_a_part() { --fields_; }
  /// That one option of this struct must not be larger than another, both added already.
  void order(const char* smaller, const char* larger);

  struct Part {
    std::string name, meaning;
  };
  const std::vector<Option>& options() const { return options_; }
  std::vector<Option>& options() { return options_; }
  const std::vector<Part>& parts() const { return parts_; }

  /// Null when there is none of that name.
  Option* find(std::string_view name);
  /// The name most like one that is none: that of a part or an option.
  std::string nearest(std::string_view name) const;
  /// Sets one option by "part.field=value". Throws `Error`.
  void assign(const std::string& assignment);
  /// Throws `Error` for the first option that is out of bounds.
  void check() const;

 private:
  template <class Options>
  void describe(Options& options) {
    fields_ = 0;
    options.describe(*this);
    expect_fields(field_count<Options>());
  }
  void append(Option option) {
    ++fields_;
    options_.push_back(std::move(option));
  }
  void expect_fields(std::size_t count) const;

  std::string path_;        // of the struct that is being described, with a dot at its end
  std::size_t fields_ = 0;  // of it, so far
  std::vector<Option> options_;
  std::vector<Part> parts_;
  std::vector<std::pair<std::string, std::string>> ordered_;
};

/// What every options struct's `check()` does: throws `Error`, which names field, value and bound.
template <class Options>
void check_options(Options options) {
  OptionList::of(options).check();
}

}  // namespace dkp_slam
