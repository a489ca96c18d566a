// Configuration files and --set, on options of every kind.
#include <cstdint>
#include <filesystem>
#include <string>

#include "dkp_slam/config/yaml/option_file.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

enum class Colour { red, green };

struct Brush {
  double width = 0.5;
  bool wet = true;
  std::filesystem::path drawing = "brush.png";

  void describe(OptionList& list) {
    list.add("width", width, positive_share(), "metres", "of the brush");
    list.add("wet", wet, "leave it so");
    list.add("drawing", drawing, "of it");
  }
};

struct Paint {
  std::string name = "the wall's";
  Colour colour = Colour::green;
  Brush brush;
  float thickness = 0.3F;
  std::uint64_t seed = 1;
  int least = 3, most = 5;

  void describe(OptionList& list) {
    list.add("name", name, "of the paint");
    list.add("colour", colour, {{Colour::red, "red"}, {Colour::green, "green"}}, "of the paint");
    list.add_part("brush", brush, "what it is painted with");
    list.add("thickness", thickness, at_least(0), "metres", "of the paint");
    list.add("seed", seed, any_number(), "", "of the drops");
    list.add("least", least, between(0, 1000), "", "coats");
    list.add("most", most, above(0), "", "coats");
    list.order("least", "most");
  }
};

struct Options {
  Paint paint;
  bool quiet = false;

  void describe(OptionList& list) {
    list.add_part("paint", paint, "what is painted");
    list.add("quiet", quiet, "say nothing");
  }
};

void run(Bytes bytes) {
  Reader input(bytes);
  const bool single = input.below(2) == 1;
  Options options;
  OptionList list = OptionList::of(options);
  const InputFile file(input.rest());
  const bool taken = takes([&] {
    if (single) {
      list.assign(text_of(input.rest()));
    } else {
      read_option_file(file.path(), list);
    }
  });
  // What one option may be is looked at where it is read, what two may be together where all are.
  if (!taken || !takes([&] { list.check(); })) return;
  const std::string text = option_file_text(list);
  Options again;
  OptionList same = OptionList::of(again);
  const InputFile written(bytes_of(text));
  require(takes([&] { read_option_file(written.path(), same); }), "what was written is refused");
  require(option_file_text(same) == text, "written and read it differs");
}

std::vector<std::string> seeds() {
  Options options;
  return {
      '\0' + option_file_text(OptionList::of(options)),
      std::string("\0paint:\n  colour: red\n  brush: {width: 1e-3, wet: false}\nquiet: true\n", 69),
      "\1paint.brush.drawing=''''",
      "\1paint.seed=18446744073709551615",
      "\1paint.least=7",
      "\1paint.thickness=1e-38"};
}

const Registration registration({"configuration", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
