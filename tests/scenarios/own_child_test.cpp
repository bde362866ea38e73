// SPDX-License-Identifier: Apache-2.0
// A child of the pin stream that is not the bench's (fixtures/children/script_child.py), in a whole run.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Port and bit of each output of the controller in fixtures/machines/two-mirror-gated.yaml.
const std::map<std::string, std::pair<int, int>> kPins{{"galvo_x_pul", {0, 0}},
                                                       {"galvo_x_dir", {0, 1}},
                                                       {"galvo_y_pul", {0, 2}},
                                                       {"galvo_y_dir", {0, 3}},
                                                       {"laser_gate", {2, 2}}};

/// Pins of a recording as an image of the script child: lines "TICK PORT LEVEL".
std::string scriptOf(const std::filesystem::path& vcd) {
  constexpr long long kTick_100ps = 625;  // 16 MHz
  std::map<std::string, std::pair<int, int>> wires;
  std::map<int, unsigned> levels;
  std::string script;
  std::istringstream file(textOf(vcd));
  long long tick = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word, type, width, id, name;
    if (line.starts_with("$var")) {
      words >> word >> type >> width >> id >> name;
      if (const auto pin = kPins.find(name); pin != kPins.end()) wires[id] = pin->second;
    } else if (line.starts_with('#')) {
      tick = std::stoll(line.substr(1)) / kTick_100ps;
    } else if (const auto wire = wires.find(line.substr(line.empty() ? 0 : 1));
               wire != wires.end() && tick > 0) {
      const auto [port, bit] = wire->second;
      levels[port] = (levels[port] & ~(1U << bit)) | (line[0] == '1' ? 1U << bit : 0U);
      script += fmt::format("{} {} {}\n", tick, port, levels[port]);
    }
  }
  return script;
}

TEST(OwnChild, IsJudgedByItsPinsAsAnEmulatorIs) {
  const ScratchFolder scratch;
  const ProgramRun emulated =
      fastRunOf(scenarioWith("pins/plate.yaml", "name: emulated\n", scratch), scratch);
  ASSERT_EQ(emulated.exit_code, 0) << emulated.output;
  std::ofstream(scratch.path() / "plate.txt") << scriptOf(scratch.path() / "emulated/latest/pins.vcd");
  const ProgramRun own = fastRunOf(
      scenarioWith(
          "pins/plate.yaml",
          fmt::format("name: own\nfirmware: {{source: child, child: '{}', image: {}, dialog: none}}\n",
                      fixture("children/script_child.py").string(), (scratch.path() / "plate.txt").string()),
          scratch),
      scratch);
  EXPECT_EQ(own.exit_code, 0) << own.output;
  EXPECT_THAT(own.output, HasSubstr("the controller's own job, which starts by itself"));
  const nlohmann::json first = verdictOf(scratch.path() / "emulated");
  const nlohmann::json second = verdictOf(scratch.path() / "own");
  ASSERT_EQ(second.at("pulses").size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(second.at("pulses")[i].at("pulses"), first.at("pulses")[i].at("pulses"));
  // What the reference controller says of itself, nobody hears here.
  EXPECT_THAT(checksThat(second, "FAIL"), IsEmpty());
  EXPECT_GT(checksThat(second, "PASS").size(), 12U);
}

}  // namespace
}  // namespace kerfbench::test
