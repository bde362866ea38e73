// SPDX-License-Identifier: Apache-2.0
// Purpose of a calibration: a job fails on a head that is mounted and not calibrated, and passes with the
// table that `calibrate head` wrote for it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;
namespace fs = std::filesystem;

/// Names of the checks that are not judged, those that do not apply left out.
std::vector<std::string> notJudged(const nlohmann::json& verdict) {
  std::vector<std::string> names;
  for (const auto& check : verdict.at("not_judged"))
    if (check.at("applies")) names.push_back(check.at("name"));
  return names;
}

class CalibratedCarton : public testing::Test {
 protected:
  [[nodiscard]] nlohmann::json run(const fs::path& scenario, const std::string& name, int exit_code) const {
    const ProgramRun run = kerfbench(fmt::format("run '{}' --twin fast --no-pictures --results-dir '{}'",
                                                 scenario.string(), scratch_.path().string()));
    EXPECT_EQ(run.exit_code, exit_code) << run.output;
    return verdictOf(scratch_.path() / name);
  }
  /// Scenario on the machine with a table and no other change.
  [[nodiscard]] fs::path withTable(const fs::path& machine, const fs::path& table,
                                   const fs::path& scenario) const {
    std::ofstream(scratch_.path() / "machine.yaml")
        << fmt::format("extends: '{}'\nname: two-mirror-mounted\ncontroller: {{correction: '{}'}}\n",
                       machine.string(), table.string());
    const fs::path corrected = scratch_.path() / "corrected.yaml";
    std::ofstream(corrected) << fmt::format("extends: '{}'\nname: corrected\nmachine: machine.yaml\n",
                                            scenario.string());
    return corrected;
  }
  /// Runs on the AVR release without a table, then all of these with it.
  void expectATableMends(const std::vector<fs::path>& scenarios) const;
  ScratchFolder scratch_;
};

using CalibratedCartonLong = CalibratedCarton;

void CalibratedCarton::expectATableMends(const std::vector<fs::path>& scenarios) const {
  const fs::path on_avr = fixture("scenarios/carton-mounted.yaml");
  const fs::path machine = fixture("machines/two-mirror-mounted.yaml");
  const auto before = run(on_avr, "carton-mounted", 1);
  EXPECT_THAT(checksThat(before, "FAIL"), Contains("path"));
  EXPECT_THAT(checksThat(before, "FAIL"), Contains("spot_path"));
  // What needs to know which line the spot follows has nothing to say.
  for (const char* dependent : {"stillness_x", "stillness_peak", "gate_lag"})
    EXPECT_THAT(notJudged(before), Contains(dependent));
  ASSERT_FALSE(before.at("model").at("sampled").empty());

  // The calibration samples the same head by the same seed.
  const fs::path head = scratch_.path() / "head";
  const ProgramRun calibrated =
      kerfbench(fmt::format("calibrate head --machine '{}' --seed 5 --limit-mm 0.015 --results-dir '{}'",
                            machine.string(), head.string()));
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.output;

  for (const fs::path& scenario : scenarios) {
    const auto after = run(withTable(machine, head / "correction.csv", scenario), "corrected", 0);
    EXPECT_EQ(after.at("verdict"), "PASS") << scenario;
    EXPECT_EQ(after.at("model").at("sampled"), before.at("model").at("sampled"));
    EXPECT_EQ(after.at("firmware") == before.at("firmware"), scenario == on_avr);
  }
}

TEST_F(CalibratedCarton, FailsOnAMountedHeadAndPassesWithItsTable) {
  expectATableMends({fixture("scenarios/carton-mounted.yaml")});
}
TEST_F(CalibratedCartonLong, FailsOnAMountedHeadAndPassesWithItsTable) {
  expectATableMends(
      {fixture("scenarios/carton-mounted.yaml"), fixture("scenarios/native/carton-mounted.yaml")});
}

}  // namespace
}  // namespace kerfbench::test
