// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/preview/preview.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/program/plan.h"
#include "tests/firmware_under_test/planner/player.h"

namespace kerfbench::planner {
namespace {

/// Ends of periods on the sheet, with the laser on or off.
struct Motion {
  std::vector<Eigen::Vector2d> place_mm;
  std::vector<bool> burns;

  /// Motion from the first period that burns to the last.
  [[nodiscard]] Motion burnt() const {
    const auto first = std::find(burns.begin(), burns.end(), true) - burns.begin();
    const auto behind = burns.rend() - std::find(burns.rbegin(), burns.rend(), true);
    return {{place_mm.begin() + first, place_mm.begin() + behind},
            {burns.begin() + first, burns.begin() + behind}};
  }
};

/// Motion that a page plays, read from its data.
Motion playedBy(const std::string& page) {
  const std::string begin = "<script id=job type='application/json'>";
  const std::size_t from = page.find(begin) + begin.size();
  const auto data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  Motion motion;
  long long x = 0, y = 0;  // In units of 1e-9 mm.
  for (std::size_t i = 0; i < data["x"].size(); ++i) {
    x += data["x"][i].get<long long>();
    y += data["y"][i].get<long long>();
    motion.place_mm.push_back(1e-9 * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y)));
    motion.burns.push_back(data["power"][i] > 0);
  }
  return motion.burnt();
}

/// Motion of a program's only unit, decoded from its steps.
Motion decoded(const Program& program, const MachineParameters& machine, const JobParameters& job) {
  Motion motion;
  for (const test::Period& period : test::play(program, machine, job).periods) {
    motion.place_mm.push_back(period.to_S_mm);
    motion.burns.push_back(period.power > 0);
  }
  return motion.burnt();
}

/// A job of one unit that is played and decoded.
struct Case {
  const char* name;
  dieline::Dieline dieline;
  double belt_mm_s, jump_radius_mm, reach_mm;
};
void PrintTo(const Case& it, std::ostream* out) { *out << it.name; }

class Preview : public testing::TestWithParam<Case> {};

TEST_P(Preview, PlaysThePeriodsOfTheProgram) {
  MachineParameters machine = test::twoMirror();
  machine.field_min_mm[0] = -GetParam().reach_mm;
  machine.field_max_mm[0] = GetParam().reach_mm;
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = GetParam().belt_mm_s;
  job.jump_radius_mm = GetParam().jump_radius_mm;
  const Plan plan = planner::plan(GetParam().dieline, machine, job);
  const Motion shown = playedBy(previewHtml("job", plan.gcode, machine, job));
  const Motion sent = decoded(plan.program, machine, job);
  ASSERT_EQ(shown.place_mm.size(), sent.place_mm.size());
  EXPECT_EQ(shown.burns, sent.burns);
  double farthest_mm = 0.0;
  for (std::size_t i = 0; i < sent.place_mm.size(); ++i)
    farthest_mm = std::max(farthest_mm, (shown.place_mm[i] - sent.place_mm[i]).norm());
  EXPECT_LT(farthest_mm, 1e-9);
}

TEST(PreviewPage, AJobThatDoesNotFitIsShownAsPlanned) {
  const MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  const Plan good = planner::plan(test::label(), machine, job);
  job.belt_speed_mm_s = 5000.0;
  const std::string page = previewHtml("job", good.gcode, machine, job);
  EXPECT_THAT(page, testing::HasSubstr("does not fit"));
  EXPECT_FALSE(playedBy(page).place_mm.empty());
}

INSTANTIATE_TEST_SUITE_P(Jobs, Preview,
                         testing::Values(Case{"label", test::label(), 60.0, 0.0, 80.0},
                                         Case{"label with smooth jumps", test::label(), 60.0, 3.0, 80.0},
                                         Case{"carton whose smooth jumps wait for the sheet", test::carton(),
                                              8.0, 3.0, 60.0}),
                         [](const auto& tested) { return std::to_string(tested.index); });

}  // namespace
}  // namespace kerfbench::planner
