// Configuration files and --set, on options of every kind.
#include <filesystem>
#include <string>

#include "dkp_slam/config/test_options.h"
#include "dkp_slam/config/yaml/option_file.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

struct Options {
  testing::Paint paint;
  std::filesystem::path drawing = "brush.png";

  void describe(OptionList& list) {
    list.add_part("paint", paint, "what is painted");
    list.add("drawing", drawing, "of it");
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
      std::string("\0paint:\n  colour: red\n  wet: false\n  brush: {width: 1e-3}\ndrawing: a.png\n",
                  73),
      "\1drawing=''''",
      "\1paint.seed=18446744073709551615",
      "\1paint.least=7",
      "\1paint.thickness=1e-38"};
}

const Registration registration({"configuration", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
