// SPDX-License-Identifier: Apache-2.0
// The preview of every shipped scenario, held against its program, which tests/…/player.h reads by itself.
#include "hil/desk/job_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/head/stepper.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/unit_motion.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "hil/scenario/case.h"
#include "tests/firmware_under_test/planner/player.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using nlohmann::json;

json plan(const std::string& text, const fs::path& file,
          const std::optional<std::string>& gcode = std::nullopt) {
  return json::parse(planJson({text, file}, gcode, kRequest));
}

/// A scenario's job as a run plans it.
struct Job {
  planner::MachineParameters machine;
  planner::JobParameters job;
  planner::PlannerFaults faults;
  std::string gcode;
  planner::CheckResult checked;
  planner::Plan plan;
};

/// Nothing for a scenario that has no program of the planner's.
std::optional<Job> jobOf(const fs::path& file) {
  try {
    const scenario::Case whole = scenario::readCase(file, {kBuild / "firmware"});
    if (whole.scenario.firmware.dialog != scenario::FirmwareChoice::Dialog::kKerfbench) return std::nullopt;
    Job job{scenario::targetedMachine(whole),
            scenario::plannerJob(whole),
            whole.scenario.planner_faults,
            {},
            {},
            {}};
    job.gcode = whole.scenario.job_gcode.empty()
                    ? planner::makeGcode(*whole.dieline, job.machine, job.job, job.faults)
                    : base::contentOf(whole.scenario.job_gcode);
    job.checked = planner::checkJob(job.gcode, job.machine, job.job, job.faults);
    job.plan = planner::planFromChecked(job.checked, job.gcode, job.machine, job.job, job.faults);
    return job;
  } catch (const base::ConfigError&) {
  } catch (const dieline::DielineError&) {
  } catch (const planner::PlanError&) {
  }
  return std::nullopt;
}

/// Where the units' own periods stand among all periods of a program.
std::size_t periodsBefore(const planner::Program& program, std::size_t op) {
  std::size_t periods = 0;
  for (std::size_t i = 0; i < op; ++i) periods += (program.ops[i][0] & 0x80U) != 0 ? 1 : 0;
  return periods;
}

/// The places of a preview against those of the program as the player decodes it by the head's formulas.
void expectPlayedPlaces(const json& preview, const Job& job) {
  const planner::test::Played played = planner::test::play(job.plan.program, job.machine, job.job);
  // With return_unchecked the planner sends what the head cannot do: it is to come too late for a mark.
  if (!job.faults.return_unchecked) ASSERT_TRUE(played.error.empty()) << played.error;
  const std::size_t first = periodsBefore(job.plan.program, job.plan.program.units[0].begin);
  ASSERT_LE(first + preview["x_mm"].size() - 1, played.periods.size());
  double farthest_mm = 0.0;
  for (std::size_t i = 1; i < preview["x_mm"].size(); ++i) {
    const planner::test::Period& period = played.periods[first + i - 1];
    farthest_mm =
        std::max(farthest_mm, (Vector2d(preview["x_mm"][i], preview["y_mm"][i]) - period.to_S_mm).norm());
    ASSERT_EQ(preview["gate"][i], period.power >= 0 ? 1 : 0) << i;
    ASSERT_EQ(preview["power"][i], std::max(period.power, 0)) << i;
  }
  EXPECT_LE(farthest_mm, 1e-9);
}

/// The places of a preview are those whose steps, by the head and its table, are the program's; and no axis
/// is farther from its planned place than the choice of whole steps may be.
void expectStepsOfThePlan(const json& preview, const Job& job) {
  const planner::Axes axes(job.machine, job.faults);
  const planner::UnitMotion motion =
      planner::unitMotion(job.plan.program, 0, *job.checked.solution, job.machine, job.job, axes);
  ASSERT_EQ(motion.periods.size() + 1, preview["x_mm"].size());
  const double reach = job.machine.steppers.resonance_hz > 0.0 ? 2.0 : 0.5;
  const bool sees_belt = !job.faults.ignore_belt;
  for (std::size_t i = 1; i < preview["x_mm"].size(); ++i) {
    const planner::UnitPeriod& period = motion.periods[i - 1];
    const Vector2d p_S(preview["x_mm"][i], preview["y_mm"][i]);
    ASSERT_LE((p_S - period.p_S_mm).cwiseAbs().maxCoeff(), 1e-9) << i;
    const Vector2d steps = axes.stepsAt(period.p_W_mm);
    ASSERT_LE((axes.stepsPerMm(period.p_W_mm).inverse() * (steps - period.steps.cast<double>())).norm(), 1e-9)
        << i;
    if (!sees_belt) continue;
    const double web_x_mm = period.p_W_mm.x() - period.p_S_mm.x();
    Vector2d wanted = axes.stepsAt(period.planned_S_mm + Vector2d(web_x_mm, 0.0));
    for (int axis = 0; axis < 2; ++axis) {
      wanted[axis] = planner::againstDetent(wanted[axis], job.machine.steppers);
      // A sheet that the controller feeds goes on in steps, too.
      const double fed = job.job.feed_by_controller && axis == 0
                             ? job.machine.feed_step_mm * axes.stepsPerMm(period.p_W_mm)(0, 0)
                             : 0.0;
      ASSERT_LE(std::abs(wanted[axis] - period.steps[axis]), reach + fed + 1e-6) << i << " axis " << axis;
    }
  }
}

class EveryShipped : public testing::Test {
 protected:
  /// Calls for each shipped scenario with a program of the planner's.
  template <typename Do>
  int each(const Do& action) {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(base::fixture("scenarios"))) {
      if (entry.path().extension() != ".yaml") continue;
      const std::optional<Job> job = jobOf(entry.path());
      const json answer = plan(base::contentOf(entry.path()), entry.path());
      EXPECT_EQ(answer["fits"], job.has_value()) << entry.path() << answer["issues"];
      if (!job || !answer["fits"]) continue;
      SCOPED_TRACE(entry.path().string());
      ++count;
      action(*job, answer);
    }
    return count;
  }
};

TEST_F(EveryShipped, PreviewIsTheProgramsOwnPeriods) {
  int played = 0;
  const int all = each([&](const Job& job, const json& answer) {
    EXPECT_EQ(answer["gcode"], job.gcode);
    EXPECT_EQ(answer["preview"]["stride"], 1);
    EXPECT_NEAR(answer["facts"]["unit_time_s"], job.plan.unit_time_s, 1e-12);
    EXPECT_NEAR(static_cast<double>(answer["preview"]["x_mm"].size() - 1) *
                    answer["preview"]["period_s"].get<double>(),
                job.plan.unit_time_s, 1e-9);
    expectStepsOfThePlan(answer["preview"], job);
    // The player has the formulas of two mirrors and of a gantry, and a belt at the planned speed.
    const bool has_formula = !job.machine.correction && !job.faults.no_pincushion &&
                             job.machine.head != planner::MachineParameters::Head::kFTheta;
    if (!has_formula) return;
    ++played;
    expectPlayedPlaces(answer["preview"], job);
  });
  EXPECT_GT(all, 60);
  EXPECT_GT(played, 50);
}

class PlanOfText : public testing::Test {
 protected:
  const fs::path file_ = base::fixture("scenarios/native/label-on-belt.yaml");
  const std::string text_ = base::contentOf(file_);
};

TEST_F(PlanOfText, LinesAndEntitiesAreLinkedBothWays) {
  const json answer = plan(text_, file_);
  std::vector<std::string> lines;
  std::istringstream stream(answer["gcode"].get<std::string>());
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::set<int> entities;
  for (const json& stretch : answer["entity_lines"]) {
    for (int line = stretch["line_first"]; line <= stretch["line_last"]; ++line) {
      const std::string& code = lines[static_cast<std::size_t>(line) - 1];
      if (code.starts_with("G"))
        EXPECT_THAT(code, testing::HasSubstr(fmt::format("(E{} ", stretch["entity"].get<int>())));
    }
    entities.insert(stretch["entity"].get<int>());
  }
  EXPECT_EQ(entities.size(), answer["order"].size());
  // Each period has a line and an entity that belong together.
  std::vector<int> line_of, entity_of;
  for (const json& run : answer["preview"]["line"])
    line_of.insert(line_of.end(), run[1].get<std::size_t>(), run[0]);
  for (const json& run : answer["preview"]["entity"])
    entity_of.insert(entity_of.end(), run[1].get<std::size_t>(), run[0]);
  ASSERT_EQ(line_of.size(), answer["preview"]["x_mm"].size());
  ASSERT_EQ(entity_of.size(), line_of.size());
  int lit = 0;
  for (std::size_t i = 0; i < line_of.size(); ++i) {
    if (answer["preview"]["gate"][i] == 0) continue;
    ++lit;
    ASSERT_LE(static_cast<std::size_t>(line_of[i]), lines.size());
    EXPECT_TRUE(lines[static_cast<std::size_t>(line_of[i]) - 1].starts_with("G0"));
  }
  EXPECT_GT(lit, 100);
}

TEST_F(PlanOfText, GcodeOfTheUsersOwnIsPlannedAndItsFaultsHaveLines) {
  const std::string own = "G00 X-40 Y0 Z0\nG01 X-20 Y0 Z1\n";
  const json good = plan(text_, file_, own);
  EXPECT_TRUE(good["fits"]) << good["issues"];
  EXPECT_EQ(good["gcode"], own);
  EXPECT_NEAR(good["facts"]["cut_length_mm"], 20.0, 1e-9);
  const json bad = plan(text_, file_, "G00 X-40 Y0 Z0\nG01 X-20 Q1 Z1\nG01 X-30 Z7\n");
  EXPECT_FALSE(bad["fits"]);
  EXPECT_TRUE(bad["preview"].is_null());
  ASSERT_EQ(bad["issues"].size(), 2U) << bad["issues"];
  EXPECT_EQ(bad["issues"][0]["line"], 2);
  EXPECT_EQ(bad["issues"][1]["line"], 3);
  EXPECT_EQ(bad["issues"][0]["source"], "gcode");
  // The file of planner.gcode need not be there while its text is in an editor.
  const std::string named = text_ + "planner: {gcode: not-there-yet.gcode}\n";
  EXPECT_TRUE(plan(named, file_, own)["fits"]);
  EXPECT_FALSE(plan(named, file_)["fits"]);
}

TEST_F(PlanOfText, WhatDoesNotFitSaysWhy) {
  const json fast = plan(text_ + "belt: {speed_mm_s: 900}\n", file_);
  EXPECT_FALSE(fast["fits"]);
  EXPECT_EQ(fast["issues"][0]["source"], "job");
  EXPECT_FALSE(fast["gcode"].get<std::string>().empty());
  const json faulty = plan(text_ + "chekcs: 1\n", file_);
  EXPECT_FALSE(faulty["fits"]);
  EXPECT_EQ(faulty["issues"][0]["line"], base::lineOf(text_ + "chekcs: 1\n", "chekcs"));
  const json by_lines = plan("extends: ../line-ok/plate.yaml\nname: x\n", file_);
  EXPECT_FALSE(by_lines["fits"]);
  EXPECT_THAT(by_lines["issues"].dump(), testing::HasSubstr("line-ok"));
}

}  // namespace
}  // namespace kerfbench::desk
