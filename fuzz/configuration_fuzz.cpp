// Configuration files and --set, on the options of the detectors.
#include "dkp_slam/config/yaml/option_file.h"
#include "dkp_slam/detection/options/detector_options.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void run(Bytes bytes) {
  Reader input(bytes);
  const bool single = input.below(2) == 1;
  DetectorOptions options;
  OptionList list = OptionList::of(options);
  const InputFile file(input.rest());
  const bool taken = takes([&] {
    if (single) {
      list.assign(text_of(input.rest()));
    } else {
      read_option_file(file.path(), list);
    }
  });
  if (!taken) return;
  require(takes([&] { list.check(); }), "an option out of bounds is taken");
  const std::string text = option_file_text(list);
  DetectorOptions again;
  OptionList same = OptionList::of(again);
  const InputFile written(bytes_of(text));
  require(takes([&] { read_option_file(written.path(), same); }), "what was written is refused");
  require(option_file_text(same) == text, "written and read it differs");
}

std::vector<std::string> seeds() {
  DetectorOptions options;
  return {'\0' + option_file_text(OptionList::of(options)),
          std::string("\0yolox:\n  threads: 2\n  decode: {nms_iou: 0.5}\nkind: motion\n", 58),
          "\1yolox.provider=cuda", "\1kind=none", "\1yolox.decode.lowest_score=1e-3"};
}

const Registration registration({"configuration", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
