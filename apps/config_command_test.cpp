#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/config_options.h"
#include "apps/test_command.h"
#include "apps/test_sequence.h"
#include "dkp_slam/config/option_list.h"
#include "dkp_slam/system/slam.h"

namespace dkp_slam::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A value that the option may have and does not; empty where there is none.
std::string another_value(const Option& option) {
  if (const auto* choice = std::get_if<Choice>(&option.value)) {
    return choice->names[(choice->get() + 1) % choice->names.size()];
  }
  if (const auto* flag = std::get_if<bool*>(&option.value)) return **flag ? "false" : "true";
  if (std::holds_alternative<fs::path*>(option.value)) return "another file.onnx";
  const double now = std::stod(option.text());
  for (const double v : {now + 1.0, now - 1.0, now / 2.0, (now + 1.0) / 2.0}) {
    if (option.bounds.hold(v) && v != now) return fmt::format("{:.6g}", v);
  }
  return "";
}

/// Just beyond each bound.
std::vector<std::string> forbidden_values(const Option& option) {
  std::vector<std::string> values;
  const Bounds& b = option.bounds;
  if (std::isfinite(b.lower)) {
    values.push_back(fmt::format("{}", b.without_lower ? b.lower : b.lower - 1.0));
  }
  if (std::isfinite(b.upper)) {
    values.push_back(fmt::format("{}", b.without_upper ? b.upper : b.upper + 1.0));
  }
  return values;
}

template <class F>
std::string problem_of(F&& f) {
  try {
    f();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "none";
}

TEST(SlamConfig, TheShippedDefaultIsWhatIsBuiltIn) {
  EXPECT_EQ(text_of(DKP_SLAM_CONFIG_DIR "/default.yaml"), config_text({}))
      << "make it anew: dkp-slam config > config/default.yaml";
}

TEST(SlamConfig, TheDefaultReadBackIsTheSame) {
  ConfigOptions options;
  options.file = DKP_SLAM_CONFIG_DIR "/default.yaml";
  EXPECT_EQ(config_text(make_config(options)), config_text({}));
}

TEST(SlamConfig, ThePapersValues) {
  ConfigOptions options;
  options.file = DKP_SLAM_CONFIG_DIR "/paper.yaml";
  const SlamConfig config = make_config(options);
  EXPECT_EQ(config.dynamics.mode, DynamicsMode::paper);
  EXPECT_TRUE(config.dynamics.regions.printed_equation);
  EXPECT_EQ(config.dynamics.regions.weight_high, 10.0F);
  EXPECT_EQ(config.orb.features, 1000);
  EXPECT_NO_THROW(config.check());
}

TEST(SlamConfig, EveryOptionCanBeSetAndShows) {
  SlamConfig built_in;
  const OptionList all = OptionList::of(built_in);
  EXPECT_GT(all.options().size(), 190U);
  for (const Option& option : all.options()) {
    const std::string value = another_value(option);
    ASSERT_FALSE(value.empty()) << option.name;
    SlamConfig config;
    OptionList list = OptionList::of(config);
    list.assign(option.name + "=" + value);
    SlamConfig copy = config;
    OptionList effective = OptionList::of(copy);
    for (const Option& o : all.options()) {
      EXPECT_EQ(effective.find(o.name)->text(), o.name == option.name ? value : o.text()) << o.name;
    }
  }
}

TEST(SlamConfig, EveryOptionHasAMeaningAndItsDefaultIsAllowed) {
  SlamConfig config;
  EXPECT_NO_THROW(config.check());
  const OptionList list = OptionList::of(config);
  for (const Option& option : list.options()) {
    EXPECT_FALSE(option.meaning.empty()) << option.name;
  }
}

TEST(SlamConfig, EveryBoundIsHeldAndNamed) {
  SlamConfig built_in;
  std::size_t bounds = 0;
  const OptionList list = OptionList::of(built_in);
  for (const Option& option : list.options()) {
    for (const std::string& value : forbidden_values(option)) {
      ++bounds;
      ConfigOptions options;
      options.assignments = {option.name + "=" + value};
      const std::string problem = problem_of([&] { make_config(options); });
      EXPECT_THAT(problem, HasSubstr(fmt::format("{} is '{}'; it must be ", option.name, value)));
      EXPECT_THAT(problem, HasSubstr(option.bounds.text()));
    }
  }
  EXPECT_GT(bounds, 190U);
}

TEST(SlamConfig, ASlamIsMadeOfACheckedOneOnly) {
  SlamConfig config;
  config.camera.fx = config.camera.fy = 500.0;
  config.tracking.local_keyframes = 0;
  EXPECT_EQ(problem_of([&] { Slam slam(config); }),
            "tracking.local_keyframes is 0; it must be a whole number at least 1");
  config.tracking.local_keyframes = 1;
  config.dynamics.clustering.min_clusters = 9;
  EXPECT_THAT(problem_of([&] { Slam slam(config); }),
              HasSubstr("dynamics.clustering.min_clusters is 9; it must be at most "
                        "dynamics.clustering.max_clusters, which is 8"));
}

TEST(SlamConfig, JsonHasAllOfIt) {
  SlamConfig config;
  config.tracking.belief.moved = 0.7F;
  config.detector.yolox.model = "a.onnx";
  const nlohmann::ordered_json json = config_json(config);
  EXPECT_EQ(json.at("mode"), "dkp+");
  EXPECT_EQ(json.at("detector").at("yolox").at("model"), "a.onnx");
  EXPECT_EQ(json.at("tracking").at("belief").at("moved").dump(), "0.7");
  EXPECT_EQ(json.at("realtime"), false);
}

TEST(MakeConfig, TheCommandLineComesAfterTheFile) {
  const fs::path file = fs::temp_directory_path() / "dkp_slam_make_config.yaml";
  std::ofstream(file) << "mode: dk\nseed: 5\norb: {features: 700}\n";
  ConfigOptions options{file, {"seed=6", "orb.levels=4"}, {"mode=off"}};
  const SlamConfig config = make_config(options);
  fs::remove(file);
  EXPECT_EQ(config.dynamics.mode, DynamicsMode::off);
  EXPECT_EQ(config.seed, 6U);
  EXPECT_EQ(config.orb.features, 700);
  EXPECT_EQ(config.orb.levels, 4);
}

class ConfigCommand : public testing::CommandTest {
 protected:
  fs::path file(const std::string& text) const {
    std::ofstream(folder_ / "config.yaml") << text;
    return folder_ / "config.yaml";
  }
};

TEST_F(ConfigCommand, PrintsTheEffectiveConfiguration) {
  ASSERT_EQ(call({"config"}), 0) << stderr_;
  EXPECT_EQ(stdout_, text_of(DKP_SLAM_CONFIG_DIR "/default.yaml"));
  ASSERT_EQ(call({"config", "--config", file("mode: dk\ntracking: {local_keyframes: 60}\n"),
                  "--set", "mode=d", "--set", "orb.features=900"}),
            0)
      << stderr_;
  EXPECT_THAT(stdout_, HasSubstr("\nmode: d "));
  EXPECT_THAT(stdout_, HasSubstr("\n  local_keyframes: 60 "));
  EXPECT_THAT(stdout_, HasSubstr("\n  features: 900 "));
}

TEST_F(ConfigCommand, ABadFileFailsAndABadSetIsMisuse) {
  const fs::path bad = file("tracking:\n  local_keyframes: 0\n");
  EXPECT_EQ(call({"config", "--config", bad}), 1);
  EXPECT_EQ(stderr_,
            fmt::format("dkp-slam: {}:2: tracking.local_keyframes is '0'; it must be a whole "
                        "number at least 1\n",
                        bad.string()));
  EXPECT_EQ(call({"config", "--config", folder_ / "none.yaml"}), 1);
  EXPECT_EQ(call({"config", "--config", file("orb: {fast_threshold: 5}\n")}), 1);
  EXPECT_THAT(stderr_,
              HasSubstr("orb.fast_low_threshold is 7; it must be at most orb.fast_threshold"));
  EXPECT_EQ(call({"config", "--set", "tracking.local_keyframe=3"}), 2);
  EXPECT_THAT(stderr_, HasSubstr("did you mean tracking.local_keyframes?"));
  EXPECT_EQ(call({"config", "--set", "orb.levels=x"}), 2);
  EXPECT_EQ(stdout_, "");
}

TEST_F(ConfigCommand, ARunWritesAllOfItIntoItsSummary) {
  const dkp_slam::testing::WallSequence sequence(folder_ / "sequence", 8);
  const fs::path out = folder_ / "out";
  const std::vector<std::string> command{
      "run",   sequence.folder(),  "--out",  out, "--config", file("mode: off\nseed: 4\n"),
      "--set", "orb.features=700", "--seed", "9"};
  ASSERT_EQ(call(command), 0) << stderr_;
  const auto json = nlohmann::json::parse(text_of(out / "summary.json"));
  EXPECT_EQ(json.at("options").at("mode"), "off");
  EXPECT_EQ(json.at("options").at("seed"), 9);
  EXPECT_EQ(json.at("config").at("seed"), 9);
  EXPECT_EQ(json.at("config").at("orb").at("features"), 700);
  EXPECT_EQ(json.at("config").at("detector").at("kind"), "none");
}

TEST_F(ConfigCommand, ARunRefusesABadOneBeforeItMakesAFolder) {
  const dkp_slam::testing::WallSequence sequence(folder_ / "sequence", 2);
  const std::vector<std::string> command{"run", sequence.folder(), "--out", folder_ / "out"};
  const auto with = [&](const std::vector<std::string>& more) { return call(command, more); };
  EXPECT_EQ(with({"--set", "tracking.motion_radius=0"}), 2);
  EXPECT_EQ(with({"--set", "localize_only=true"}), 2);
  EXPECT_EQ(with({"--set", "realtime=true", "--one-at-a-time"}), 2);
  EXPECT_EQ(with({"--config", file("")}), 1);
  EXPECT_THAT(stderr_, HasSubstr("config.yaml:1: empty"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace dkp_slam::apps
