// SPDX-License-Identifier: Apache-2.0
// The bench on releases that are known to be good and known to be bad.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

struct GoodCase {
  const char* name;
  const char* scenario;
};

class GoodRelease : public testing::TestWithParam<GoodCase> {};

TEST_P(GoodRelease, PassesAndSaysSo) {
  const ScratchFolder scratch;
  const auto run = kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}' --timing",
                                         fixture(GetParam().scenario).string(), scratch.path().string()));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::printf("%s", run.output.c_str());
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, GoodRelease,
    testing::Values(GoodCase{"label_avr", "scenarios/label-on-belt.yaml"},
                    GoodCase{"label_edges_avr", "scenarios/label-edges.yaml"},
                    GoodCase{"label_edges_native", "scenarios/native/label-edges.yaml"},
                    GoodCase{"label_fed", "scenarios/label-fed.yaml"},
                    GoodCase{"label_native", "scenarios/native/label-on-belt.yaml"},
                    GoodCase{"carton_avr", "scenarios/carton-on-belt.yaml"},
                    GoodCase{"carton_native", "scenarios/native/carton-on-belt.yaml"},
                    GoodCase{"three_layers_avr", "scenarios/carton-three-layers.yaml"},
                    GoodCase{"three_layers_native", "scenarios/native/carton-three-layers.yaml"},
                    GoodCase{"short_lines_avr", "scenarios/short-lines.yaml"},
                    GoodCase{"short_lines_native", "scenarios/native/short-lines.yaml"},
                    GoodCase{"button_avr", "scenarios/button.yaml"},
                    GoodCase{"button_native", "scenarios/native/button.yaml"},
                    GoodCase{"button_slow_loop_native", "scenarios/native/button-slow-loop.yaml"},
                    GoodCase{"button_jerk_native", "scenarios/native/button-jerk.yaml"},
                    GoodCase{"button_on_belt_native", "scenarios/native/button-on-belt.yaml"},
                    GoodCase{"button_straight_native", "scenarios/native/button-straight.yaml"},
                    GoodCase{"strip_avr", "scenarios/strip-crosscut.yaml"},
                    GoodCase{"strip_native", "scenarios/native/strip-crosscut.yaml"},
                    GoodCase{"strip_stop_and_go_avr", "scenarios/strip-stop-and-go.yaml"},
                    GoodCase{"strip_speed_varies_avr", "scenarios/strip-speed-varies.yaml"}),
    [](const auto& instance) { return std::string(instance.param.name); });

struct BadCase {
  const char* name;   // fixtures/scenarios/faults/<name>.yaml
  const char* check;  // The check that must fail.
};

class BadRelease : public testing::TestWithParam<BadCase> {};

TEST_P(BadRelease, FailsByTheRightCheck) {
  const ScratchFolder scratch;
  const std::string name = GetParam().name;
  const auto run =
      kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}'",
                            fixture("scenarios/faults/" + name + ".yaml").string(), scratch.path().string()));
  EXPECT_EQ(run.exit_code, 1) << run.output;
  const auto verdict = verdictOf(scratch.path() / ("fault-" + name));
  EXPECT_THAT(checksThat(verdict, "FAIL"), Contains(GetParam().check)) << run.output;
}

INSTANTIATE_TEST_SUITE_P(
    Faults, BadRelease,
    testing::Values(BadCase{"belt-ignored", "stillness_x"}, BadCase{"encoder-scale", "path"},
                    BadCase{"dir-late", "pulse_timing"}, BadCase{"pulses-lost", "path"},
                    BadCase{"pincushion-uncorrected", "path"}, BadCase{"gate-late", "gate_lag"},
                    BadCase{"edges-uncompensated", "edge"}, BadCase{"edges-wrong-side", "edge"},
                    BadCase{"button-straight-hooks", "joints"},
                    BadCase{"short-lines-open-loop", "line_energy"},
                    BadCase{"short-lines-constant-power", "even_depth"}, BadCase{"half-cut-through", "depth"},
                    BadCase{"entity-skipped", "coverage"}, BadCase{"entity-twice", "repeat"},
                    BadCase{"strip-return-slow", "finish"}, BadCase{"button-straight-fast", "path"}),
    [](const auto& instance) {
      std::string name = instance.param.name;
      std::ranges::replace(name, '-', '_');
      return name;
    });

}  // namespace
}  // namespace kerfbench::test
