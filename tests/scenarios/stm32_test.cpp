// SPDX-License-Identifier: Apache-2.0
// The reference controller's release for an STM32F103 in its emulator, and five of the known mistakes in it:
// each fails by the check by which it fails on the AVR.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scenarios/other_processor.h"

namespace kerfbench::test {
namespace {

/// Rising edges of a recording's signals in seconds, after the first of PUL of the X mirror.
std::map<std::string, std::vector<double>> risesOf(const std::filesystem::path& vcd) {
  std::map<std::string, std::string> names;
  std::map<std::string, std::vector<double>> rises;
  std::istringstream in(textOf(vcd));
  double unit_s = 0.0;
  double stamp_s = 0.0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("$timescale "))
      unit_s = std::stod(line.substr(11)) * (line.find(" ps ") != std::string::npos ? 1e-12 : 1e-9);
    if (line.starts_with("$var wire 1 ")) names[line.substr(12, 1)] = line.substr(14, line.rfind(' ') - 14);
    if (line.starts_with('#')) stamp_s = static_cast<double>(std::stoull(line.substr(1))) * unit_s;
    if (line.starts_with('1') && stamp_s > 0.0) rises[names[line.substr(1)]].push_back(stamp_s);
  }
  const double start_s = rises["galvo_x_pul"].empty() ? 0.0 : rises["galvo_x_pul"].front();
  for (auto& [name, stamps_s] : rises) {
    for (double& at_s : stamps_s) at_s -= start_s;
  }
  return rises;
}

class Stm32Release : public OtherProcessor {
 protected:
  Stm32Release() : OtherProcessor("stm32", "kerfbench-cortex-m") {}
};
using Stm32ReleaseLong = Stm32Release;

TEST_F(Stm32Release, OneLabelPasses) {
  const ProgramRun one = runOneUnit("stm32/label-on-belt");
  EXPECT_EQ(one.exit_code, 0) << one.output;
}
TEST_F(Stm32Release, DirLateFailsByPulseTiming) {
  expectFailure(runOneUnit("faults/dir-late-stm32"), "dir-late", "pulse_timing");
}
// On a sheet at rest a program is the same pulses whoever makes them. The native release's come to the tick.
TEST_F(Stm32ReleaseLong, PulsesAreThoseOfTheNativeReleaseWithinTheStampsError) {
  const std::string pins = textOf(fixture("machines/two-mirror-stm32.yaml"));
  const std::filesystem::path machine = scratch_.path() / "machine.yaml";
  std::ofstream(machine) << "extends: '" << fixture("machines/two-mirror-slow.yaml").string()
                         << "'\nname: slow-stm32\n"
                         << pins.substr(pins.find("pins:"));
  const ProgramRun native = fastRunOf(fixture("scenarios/native/button.yaml"), scratch_);
  ASSERT_EQ(native.exit_code, 0) << native.output;
  const std::string keys = fmt::format(
      "name: button-stm32\nmachine: '{}'\n"
      "firmware: {{source: cortex_m, image: controller-stm32.hex, mcu: stm32f103c8, clock_hz: 72000000}}\n",
      machine.string());
  const ProgramRun own = fastRunOf(scenarioWith("native/button.yaml", keys, scratch_), scratch_);
  ASSERT_EQ(own.exit_code, 0) << own.output;
  const auto expected = risesOf(scratch_.path() / "button" / "latest" / "pins.vcd");
  const auto found = risesOf(scratch_.path() / "button-stm32" / "latest" / "pins.vcd");
  constexpr double kStampError_s = 24 / 72e6;  // docs/reference/cortex-m-controllers.md
  for (const char* signal : {"galvo_x_pul", "galvo_y_pul", "laser_gate", "laser_pwm"}) {
    const auto& native_s = expected.at(signal);
    const auto& own_s = found.at(signal);
    ASSERT_EQ(own_s.size(), native_s.size()) << signal;
    for (std::size_t i = 0; i < own_s.size(); ++i)
      ASSERT_NEAR(own_s[i], native_s[i], kStampError_s) << signal << ", edge " << i;
  }
}
TEST_F(Stm32ReleaseLong, LabelPasses) {
  const ProgramRun whole = run("stm32/label-on-belt");
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}
TEST_F(Stm32ReleaseLong, AnOpenGuardIsSafe) {
  const ProgramRun whole = run("stm32/interlock");
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}
TEST_F(Stm32ReleaseLong, EncoderScaleFailsByPath) {
  expectFailure(run("faults/encoder-scale-stm32"), "encoder-scale", "path");
}
TEST_F(Stm32ReleaseLong, DirLateFailsByPulseTiming) {
  expectFailure(run("faults/dir-late-stm32"), "dir-late", "pulse_timing");
}
TEST_F(Stm32ReleaseLong, PulsesLostFailsByPath) {
  expectFailure(run("faults/pulses-lost-stm32"), "pulses-lost", "path");
}
TEST_F(Stm32ReleaseLong, GateLateFailsByGateLag) {
  expectFailure(run("faults/gate-late-stm32"), "gate-late", "gate_lag");
}
TEST_F(Stm32ReleaseLong, InterlockIgnoredFailsBySafeState) {
  expectFailure(run("faults/interlock-ignored-stm32"), "interlock-ignored", "safe_state");
}

}  // namespace
}  // namespace kerfbench::test
