#pragma once

#include <cstdint>
#include <string>

#include "dkp_slam/config/option_list.h"

namespace dkp_slam::testing {

enum class Colour { red, green };

struct Brush {
  double width = 0.5;
  int hairs = 100;

  void describe(OptionList& list) {
    list.add("width", width, positive_share(), "metres", "of the brush");
    list.add("hairs", hairs, between(1, 1000), "", "in it");
  }
  void check() const { check_options(*this); }
};

/// An option of every kind but a path, and a field that is none.
struct Paint {
  float thickness = 0.3F;
  std::uint64_t seed = 1;
  bool wet = true;
  std::string name = "wall";
  Colour colour = Colour::green;
  Brush brush;
  int least = 3, most = 5;
  void* maker = nullptr;  // no option

  void describe(OptionList& list) {
    list.add("thickness", thickness, at_least(0), "metres", "of the paint");
    list.add("seed", seed, any_number(), "", "of the drops");
    list.add("wet", wet, "leave it so");
    list.add("name", name, "of what is painted");
    list.add("colour", colour, {{Colour::red, "red"}, {Colour::green, "green"}}, "of the paint");
    list.add_part("brush", brush, "what it is painted with");
    list.add("least", least, any_number(), "", "coats");
    list.add("most", most, any_number(), "", "coats");
    list.order("least", "most");
    list.leave_out();
  }
  void check() const { check_options(*this); }
};

}  // namespace dkp_slam::testing
