// Lines of results.jsonl, and timings.csv.
#include "dkp_slam/evaluation/measure/timings.h"
#include "dkp_slam/evaluation/report/run_record.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

void check_timings(const std::string& csv) {
  std::size_t rows = 0;
  for (const auto& [name, values] : read_timings(csv)) {
    require(!values.empty() && (rows == 0 || values.size() == rows), "columns of different length");
    rows = values.size();
  }
}

void run(Bytes bytes) {
  Reader input(bytes);
  const bool timings = input.below(2) == 1;
  const std::string text = text_of(input.rest());
  takes([&] {
    if (timings) return check_timings(text);
    const std::string written = to_json_line(parse_json_line(text));
    require(written.find('\n') == std::string::npos, "a line of several");
    require(to_json_line(parse_json_line(written)) == written, "written and read it differs");
  });
}

std::vector<std::string> seeds() {
  RunRecord record;
  record.sequence = "walking_xyz";
  record.mode = "dkp+";
  record.detector = "motion";
  record.ate_m = 0.0123;
  record.rpe_s_m = 0.02;
  record.stage_ms = {{"tracking", 12.5}};
  return {'\0' + to_json_line(record), "\1frame,ms\n1,2.5\n2,3\n"};
}

const Registration registration({"json_lines", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
