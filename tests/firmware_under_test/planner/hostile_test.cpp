// SPDX-License-Identifier: Apache-2.0
// Absurd, contradictory and malicious input: refused with line and reason, in bounded time, never a NaN.
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::refusal;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string faultsIn(const std::string& text) {
  return refusal([&] { readGcode(text); });
}

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string operator()(const std::string& text) {
    std::vector<std::string> lines{""};
    for (const char c : text) {
      if (c == '\n')
        lines.emplace_back();
      else
        lines.back() += c;
    }
    const std::size_t edits = 1 + below(4);
    for (std::size_t i = 0; i < edits; ++i) edit(lines);
    std::string out;
    for (const std::string& line : lines) out += line + "\n";
    return out;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  void edit(std::vector<std::string>& lines) {
    const std::size_t at = below(lines.size());
    std::string& line = lines[at];
    switch (below(8)) {
      case 0:
        lines.erase(lines.begin() + std::ptrdiff_t(at));
        if (lines.empty()) lines.emplace_back();
        break;
      case 1:
        lines.insert(lines.begin() + std::ptrdiff_t(below(lines.size())), std::string(line));
        break;
      case 2:
        std::swap(lines[at], lines[below(lines.size())]);
        break;
      case 3:
      case 4:
        changeNumber(line);
        break;
      case 5:
        if (!line.empty()) line[below(line.size())] = static_cast<char>(below(256));
        break;
      case 6:
        if (!line.empty()) line.erase(below(line.size()), 1 + below(6));
        break;
      default:
        line += kInserts[below(kInserts.size())];
        break;
    }
  }

  void changeNumber(std::string& line) {
    const std::size_t letter = line.find_first_of("XYZIJG", below(line.size() + 1));
    if (letter == std::string::npos) return;
    const std::size_t end = std::min(line.find_first_not_of("0123456789.-+", letter + 1), line.size());
    line.replace(letter + 1, end - letter - 1, kNumbers[below(kNumbers.size())]);
  }

  static constexpr std::array<const char*, 17> kNumbers{
      "0",       "-0", "1e308", "1e-308", "nan", "inf", "99999",       "-99999.9999", "0.0000001",
      "0.00005", "1",  "3",     "",       "-",   "..",  "100000.0001", "2147483648"};
  static constexpr std::array<const char*, 9> kInserts{"(", ")",     "((",   " G02 I1 J1", " X0",
                                                       ";", " Z0.5", " M30", " (E7 cut)"};
  std::mt19937 random_;
};

TEST(Hostile, MutatedGcodeIsPlannedOrRefusedWithItsLine) {
  Mutator mutate(20140917);
  JobParameters job = test::mirrorJob();
  int planned = 0;
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    job.belt_speed_mm_s = round % 4 == 0 ? 40.0 : 0.0;
    const dieline::Dieline dieline = round % 3 == 0 ? test::carton() : test::label();
    static const std::string carton = makeGcode(test::carton(), test::twoMirror(), test::mirrorJob());
    static const std::string label = makeGcode(test::label(), test::twoMirror(), test::mirrorJob());
    const std::string text = mutate(round % 3 == 0 ? carton : label);
    SCOPED_TRACE(text);
    const CheckResult checked = checkJob(text, test::twoMirror(), job);
    if (!checked.solution) {
      ++refused;
      ASSERT_FALSE(checked.errors.empty());
      for (const std::string& error : checked.errors) {
        ASSERT_THAT(error, ::testing::AnyOf(HasSubstr("line "), HasSubstr("it holds no line"),
                                            HasSubstr("belt"), HasSubstr("from E"), HasSubstr("would take")));
        ASSERT_THAT(error, Not(HasSubstr("nan")));
      }
      continue;
    }
    ++planned;
    const Plan plan = planFromGcode(text, test::twoMirror(), job);
    for (const double value :
         {plan.unit_time_s, plan.cycle_time_s, plan.cut_length_mm, plan.jump_length_mm, plan.x_ref_mm})
      ASSERT_TRUE(std::isfinite(value));
    const test::Played played = test::play(plan.program, test::twoMirror(), job);
    ASSERT_EQ(played.error, "");
    for (const test::Period& period : played.periods) {
      ASSERT_TRUE(period.to_W_mm.allFinite());
      ASSERT_LE(period.largest_steps, KB_MAX_STEPS_PER_PERIOD);
      ASSERT_LE(period.to_W_mm.cwiseAbs().maxCoeff(), 80.1) << "the beam stays in the field";
    }
  }
  // The inputs must be neither all harmless nor all unreadable.
  EXPECT_GT(planned, 200);
  EXPECT_GT(refused, 400);
}

TEST(Hostile, WordsThatAreNoGcode) {
  const std::string faults = faultsIn(
      "G00 X0 Y0\n"
      "G01 Xnan Y0 Z1\n"            // 2
      "G01 X1e308 Y0\n"             // 3
      "G01 Xinf\n"                  // 4
      "G01 X1 A5 C7\n"              // 5
      "G01 X5 (a (b) c)\n"          // 6
      "G02 X10 Y0 I5\n"             // 7: off by far, from (0, 0)
      "G02 X10 Y0 I99999 J99999\n"  // 8
      "G92 X0\n"                    // 9
      "G01 X0x10\n"                 // 10
      "G01 X\x1b[2J\n"              // 11
      "G00\n"                       // 12: nowhere, harmless
      "G01 X1 F1e9999\n");          // 13
  for (const int line : {2, 3, 4, 5, 6, 8, 9, 10, 11, 13})
    EXPECT_THAT(faults, HasSubstr("line " + std::to_string(line) + ":"));
  EXPECT_THAT(faults, HasSubstr("line 6: a '(' within a comment"));
  EXPECT_THAT(faults, Not(HasSubstr("\x1b"))) << "nothing of the file reaches the terminal as it is";
}

TEST(Hostile, AMillionFaultsAreAHundredLines) {
  std::string text;
  for (int i = 0; i < 1'000'000; ++i) text += "Q\n";
  const std::string faults = faultsIn(text);
  EXPECT_LT(faults.size(), 10'000U);
  EXPECT_THAT(faults, HasSubstr("and 999900 faults more"));
  EXPECT_LT(faultsIn("G01 X" + std::string(1 << 20, '1') + "\n").size(), 200U);
}

TEST(Hostile, TooManyMovesAndTooLongJobsAreRefused) {
  std::string text = "G0 X0 Y0 Z0\n";
  for (int i = 0; i < 600'000; ++i) text += i % 2 == 0 ? "G1 X-9 Z1\n" : "G1 X0\n";
  EXPECT_THAT(faultsIn(text), HasSubstr("line 500002: more than 500000 moves"));
  EXPECT_THAT(faultsIn(std::string((64U << 20U) + 1, ' ')), HasSubstr("64 MiB"));
  JobParameters job = test::mirrorJob();
  job.mark_speed_mm_s = 0.01;
  EXPECT_THAT(refusal([&] { planFromGcode("G0 X0 Y0\nG1 X-50 Z1\n", test::twoMirror(), job); }),
              HasSubstr("a unit would take up to 5000 s"));
  job = test::mirrorJob();
  job.units = 1'000'000;
  job.pitch_mm = 1e-3;
  job.web_start_x_mm = 79.0;
  EXPECT_THAT(refusal([&] { planFromGcode("G0 X0 Y0\nG1 X-50 Z1\n", test::twoMirror(), job); }), Not(""));
}

TEST(Hostile, ParametersWithoutMeasureAreRefused) {
  const auto faults = [](const auto& change) {
    MachineParameters machine = test::twoMirror();
    JobParameters job = test::mirrorJob();
    job.belt_speed_mm_s = 10.0;
    change(machine, job);
    return jobIssues(machine, job).size();
  };
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, 1e-308, -1.0}) {
    const auto is = [&](double MachineParameters::*field) {
      return faults([&](auto& m, auto&) { m.*field = bad; });
    };
    const auto of = [&](double JobParameters::*field) {
      return faults([&](auto&, auto& j) { j.*field = bad; });
    };
    EXPECT_GE(is(&MachineParameters::throw_mm), 1U) << bad;
    EXPECT_GE(is(&MachineParameters::mirror_step_rad), 1U) << bad;
    EXPECT_GE(is(&MachineParameters::encoder_count_mm), 1U) << bad;
    EXPECT_GE(of(&JobParameters::mark_speed_mm_s), 1U) << bad;
    EXPECT_GE(of(&JobParameters::jump_speed_mm_s), 1U) << bad;
    EXPECT_GE(of(&JobParameters::acceleration_mm_s2), 1U) << bad;
    EXPECT_GE(of(&JobParameters::perforation_cut_mm), 1U) << bad;
    EXPECT_GE(of(&JobParameters::perforation_gap_mm), 1U) << bad;
  }
}

TEST(Hostile, DrawingsWithoutMeasureAreRefused) {
  const auto plan = [](const dieline::Dieline& dieline) {
    return refusal([&] { makeGcode(dieline, test::twoMirror(), test::mirrorJob()); });
  };
  dieline::Dieline dieline = test::dielineOf(
      {test::line(0, 0, 1e308, 0), test::line(0, 0, std::nan(""), 1), test::arc(0, 0, 1e7, 0, 10)});
  dieline.entities[0].origin = "line 12: LINE";
  EXPECT_THAT(plan(dieline), AllOf(HasSubstr("E0 (line 12: LINE): reaches 1e+308 mm"),
                                   HasSubstr("E1: reaches no number"), HasSubstr("E2: reaches 1e+07")));
  EXPECT_THAT(plan(test::dielineOf(std::vector<dieline::Entity>(20'001, test::line(0, 0, 1, 1)))),
              HasSubstr("20001 entities"));
  EXPECT_THAT(plan(test::dielineOf({test::line(3, 3, 3, 3)})), HasSubstr("nothing to cut"));
}

TEST(Hostile, MutatedTablesAreReadOrRefused) {
  std::string good = "x_mm,y_mm,dx_mm,dy_mm\n";
  for (int i = 0; i < 49; ++i)
    good += std::to_string(-90 + 30 * (i % 7)) + "," + std::to_string(-90 + 30 * (i / 7)) + ",0.25,-0.5\n";
  std::mt19937 random(5);
  int read = 0;
  int coarse = 0;
  for (int round = 0; round < 1000; ++round) {
    std::string text = good;
    if (round % 2 == 0) {
      // The correction changes its size: as small as a true one, or not.
      std::size_t at = text.find("0.25", random() % text.size());
      if (at != std::string::npos) text[at + 2 + random() % 2] = "0123456789"[random() % 10];
    } else if (const std::size_t at = random() % text.size(); random() % 3 == 0) {
      text.erase(at, 1 + random() % 30);
    } else {
      text[at] =
          static_cast<char>(random() % 2 == 0 ? "0123456789.,-+en\n#"[random() % 18] : char(random() % 256));
    }
    MachineParameters machine = test::twoMirror();
    const std::string why = refusal([&] {
      machine.correction = std::make_shared<CorrectionTable>(CorrectionTable::parse(text, "t.csv"));
    });
    if (machine.correction == nullptr) {
      EXPECT_THAT(why, HasSubstr("t.csv:"));
      continue;
    }
    if (!jobIssues(machine, test::mirrorJob()).empty()) {
      ++coarse;
      continue;
    }
    ++read;
    const Axes axes(machine, {});
    EXPECT_TRUE(axes.stepsAt({79, -79}).allFinite());
    EXPECT_TRUE(axes.axisLimits().allFinite());
  }
  EXPECT_GT(read, 50);
  EXPECT_GT(coarse, 50);
}

}  // namespace
}  // namespace kerfbench::planner
