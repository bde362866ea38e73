// SPDX-License-Identifier: Apache-2.0
// Depth by light, and energy per length by power meter and spot.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/spot_association.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

constexpr double kTransmission = 0.2;

double brightnessAt(double depth) {
  return (std::pow(kTransmission, 1.0 - depth) - kTransmission) / (1.0 - kTransmission);
}

/// A run with creases of this depth over the station in mm, and 0.5 % of noise.
template <typename Depth>
SyntheticRun creasedBy(const Depth& depth) {
  SyntheticRun run;
  run.limits.even_depth_share = 0.01;
  run.limits.board_transmission = kTransmission;
  std::uint32_t state = 7;
  for (int unit = 0; unit < run.evidence.print.units; ++unit) {
    for (vision::Caliper& c : run.kerf(unit, kCreaseLine).calipers) {
      state = state * 1664525U + 1013904223U;
      const double noise = 0.005 * (2.0 * (state >> 8U) / 16777216.0 - 1.0);
      c.brightness = brightnessAt(depth(c.station_mm) * (1.0 + noise));
    }
  }
  return run;
}

TEST(EvenDepth, AnEvenCreasePassesWhateverItsDepth) {
  for (const double depth : {0.2, 0.4, 0.6}) {
    const auto result = creasedBy([&](double) { return depth; }).inspected();
    EXPECT_EQ(checkOf(result, "even_depth").verdict, Verdict::kPass);
  }
}

TEST(EvenDepth, FindsAPlaceThatIsTooDeepAndHowMuch) {
  for (const double share : {0.05, -0.05}) {
    const auto run =
        creasedBy([&](double s_mm) { return 0.4 * (s_mm > 15.0 && s_mm < 22.0 ? 1.0 + share : 1.0); });
    const auto result = run.inspected();
    const Check& check = checkOf(result, "even_depth");
    EXPECT_EQ(check.verdict, Verdict::kFail);
    EXPECT_NEAR(check.value, 0.05, check.u);
    EXPECT_LT(check.u, 0.02);
    EXPECT_THAT(check.explanation,
                ::testing::HasSubstr(share > 0.0 ? " % deeper than" : " % shallower than"));
  }
}

TEST(EvenDepth, TheRoundEndIsExceptedAndTheRestOfTheLineIsNot) {
  const auto deepUpTo = [](double end_mm) {
    return creasedBy([=](double s_mm) { return s_mm < end_mm ? 0.6 : 0.4; }).inspected();
  };
  EXPECT_EQ(checkOf(deepUpTo(0.29), "even_depth").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(deepUpTo(0.8), "even_depth").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(deepUpTo(9.0), "even_depth").verdict, Verdict::kFail);
}

TEST(EvenDepth, IsJudgedFromThreeTenthsOfAMillimetreOn) {
  for (const auto& [station_mm, verdict] :
       {std::pair{0.28, Verdict::kPass}, std::pair{0.32, Verdict::kFail}}) {
    SyntheticRun run = creasedBy([](double) { return 0.4; });
    vision::Caliper& deep = run.kerf(0, kCreaseLine).calipers[1];
    deep.station_mm = station_mm;
    deep.brightness = brightnessAt(0.9);
    EXPECT_EQ(checks::evenDepthCheck(run.evidence, run.limits)->verdict, verdict) << station_mm;
  }
}

TEST(EvenDepth, NamesTheDepthAtPointsAndJudgesAllButTheStart) {
  // The crease of each unit, 80 points of it; what is off is shorter than a stretch, and farther off than it.
  const auto deepAt = [](double from_mm, double to_mm, double share) {
    auto run = creasedBy([=](double s_mm) { return 0.4 * (s_mm > from_mm && s_mm < to_mm ? share : 1.0); });
    run.limits.depth_points = 23;
    run.limits.board_thickness_mm = 0.5;
    run.evidence.beam_radius_mm = 0.0;
    return run.inspected();
  };
  const auto even = deepAt(0.0, 0.0, 1.0);
  EXPECT_EQ(checkOf(even, "even_depth").verdict, Verdict::kPass) << checkOf(even, "even_depth").explanation;
  const std::string& text = checkOf(even, "even_depth").explanation;
  EXPECT_THAT(text,
              ::testing::ContainsRegex("Depths at 23 points of unit 0, E[0-9]+, from its start on, .* in "
                                       "mm:( 0\\.(199|200)[0-9]){23}\\. But for the start"));
  EXPECT_THAT(text, ::testing::ContainsRegex("within 0\\.[0-2][0-9] % of their median"));
  // A point at which 2 mm are 4 % too deep is 1.6 % of a stretch of 5 mm, and the whole of the point.
  const double length_mm = dieline::lengthOf(SyntheticRun().dieline.entities[kCreaseLine].curve);
  const double point_mm = length_mm * 5.0 / 23.0;
  const auto deep = deepAt(point_mm - 1.0, point_mm + 1.0, 1.018);
  EXPECT_EQ(checkOf(deep, "even_depth").verdict, Verdict::kFail) << checkOf(deep, "even_depth").explanation;
  EXPECT_THAT(checkOf(deep, "even_depth").explanation,
              ::testing::ContainsRegex("within 1\\.[5-9][0-9] % of their median"));
}

TEST(EvenDepth, IsNotJudgedUnlessAsked) {
  auto run = creasedBy([](double) { return 0.4; });
  run.limits.even_depth_share = 0.0;
  EXPECT_FALSE(hasCheck(run.inspected(), "even_depth"));
}

enum class Corners { kDark, kSeen };

/// A run with a meter behind a laser that burns this energy for each millimetre that the spot runs on the
/// sheet, which lies on a belt at 200 mm/s.
SyntheticRun metered(double energy_j_mm, double strong_from_s = 1e9, double strength = 1.0,
                     Corners corners = Corners::kDark) {
  SyntheticRun run;
  run.limits.line_energy_j_mm = 0.1;
  const double quantum_j = run.evidence.power_quantum_j = 0.001;
  double energy_j = 0.0;
  auto& frames = run.evidence.spot.frames;
  const auto stepTo = [&](std::size_t i) -> Eigen::Vector2d {
    const double time_s = frames[i].mid_s - frames[i - 1].mid_s;
    return *frames[i].spot_W_mm - *frames[i - 1].spot_W_mm - Eigen::Vector2d(200.0 * time_s, 0.0);
  };
  std::vector<bool> turns(frames.size());
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    if (!frames[i - 1].spot_W_mm || !frames[i].spot_W_mm || !frames[i + 1].spot_W_mm) continue;
    turns[i] = stepTo(i).normalized().dot(stepTo(i + 1).normalized()) < 0.99;
  }
  // Between two turns the beam goes round a corner of the outline, whose sides lie along x and y.
  const auto wayTo = [&](std::size_t i) {
    return turns[i - 1] && turns[i] ? stepTo(i).lpNorm<1>() : stepTo(i).norm();
  };
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (turns[i] && corners == Corners::kDark) frames[i].spot_W_mm.reset();
  }
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!frames[i].spot_W_mm || !frames[i - 1].spot_W_mm) continue;
    const double time_s = frames[i].mid_s - frames[i - 1].mid_s;
    const double burnt_j = wayTo(i) * energy_j_mm * (frames[i].mid_s > strong_from_s ? strength : 1.0);
    for (double edge_j = (std::floor(energy_j / quantum_j) + 1.0) * quantum_j; edge_j <= energy_j + burnt_j;
         edge_j += quantum_j)
      run.evidence.power_edges_s.push_back(frames[i - 1].mid_s + time_s * (edge_j - energy_j) / burnt_j);
    energy_j += burnt_j;
  }
  return run;
}

TEST(LineEnergy, PassesWhatIsAskedAndFindsWhatIsNot) {
  const auto good = metered(0.1).inspected();
  EXPECT_EQ(checkOf(good, "line_energy").verdict, Verdict::kPass) << checkOf(good, "line_energy").explanation;
  for (const double energy_j_mm : {0.097, 0.104}) {
    const auto bad = metered(energy_j_mm).inspected();
    const Check& check = checkOf(bad, "line_energy");
    EXPECT_EQ(check.verdict, Verdict::kFail) << energy_j_mm;
    EXPECT_NEAR(check.value, std::abs(energy_j_mm / 0.1 - 1.0), 0.012);
  }
}

TEST(LineEnergy, AStretchThatIsTooStrongIsFound) {
  SyntheticRun probe;
  const double middle_s =
      0.5 * (probe.evidence.spot.frames.front().mid_s + probe.evidence.spot.frames.back().mid_s);
  const auto result = metered(0.1, middle_s, 1.05).inspected();
  EXPECT_EQ(checkOf(result, "line_energy").verdict, Verdict::kFail);
  EXPECT_THAT(checkOf(result, "line_energy").explanation, ::testing::ContainsRegex("by \\+5\\.[0-9]+ %; on"));
}

TEST(LineEnergy, AStretchIsFoundThoughItIsTheFirst) {
  // Too strong over the first 0.6 mm of the first cut only: no other stretch begins there.
  const SyntheticRun probe;
  const auto& frames = probe.evidence.spot.frames;
  const auto first = std::ranges::find_if(frames, [](const auto& f) { return f.spot_W_mm.has_value(); });
  const double strong_until_s = (first + 2)->mid_s + 1e-4;
  const SyntheticRun run = metered(0.13, strong_until_s, 0.1 / 0.13);
  const Finding check = checks::lineEnergyCheck(
      run.evidence, run.limits, followDieline(run.evidence.spot, run.dieline, run.evidence.gates));
  EXPECT_EQ(check->verdict, Verdict::kFail) << check->explanation;
}

TEST(LineEnergy, RisesEvenlyFromOneQuantumToTheNext) {
  // A quantum is what the laser burns over 0.2 mm, 7 % of a stretch; frames lie anywhere between two of them.
  constexpr double kSpeed_mm_s = 300.0;
  constexpr double kEnergy_j_mm = 0.1;
  SyntheticRun run;
  run.limits.line_energy_j_mm = kEnergy_j_mm;
  run.evidence.power_quantum_j = 0.02;
  LitFrames lit;
  for (int i = 0; i < 190; ++i) {
    LitFrame& frame = lit.frames.emplace_back();
    frame.time_s = 0.1 + 1e-3 * i;
    frame.entity = kBottom;
    frame.p_S_mm = {1e-3 * kSpeed_mm_s * i, 0.0};
    frame.sigma_mm = 0.002;
  }
  lit.runs = {{0, lit.frames.size()}};
  const double apart_s = run.evidence.power_quantum_j / kEnergy_j_mm / kSpeed_mm_s;
  for (double edge_s = 0.09; edge_s < 0.31; edge_s += apart_s) run.evidence.power_edges_s.push_back(edge_s);
  EXPECT_THAT(checks::lineEnergyCheck(run.evidence, run.limits, lit)->explanation,
              ::testing::ContainsRegex("departs the most from 0.1 J/mm: by [+-]0\\.0[0-9] %"));
}

TEST(LineEnergy, TheWayRoundEachCornerCountsInFull) {
  // The chord between two frames, each 0.3 mm from a corner, is 0.18 mm too short: 6 % of a stretch.
  const auto result = metered(0.1, 1e9, 1.0, Corners::kSeen).inspected();
  const Check& check = checkOf(result, "line_energy");
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
  EXPECT_LT(check.value, 0.01) << check.explanation;
}

TEST(LineEnergy, TellsByHowMuchTheWorstStretchDepartsAndTheMean) {
  const auto result = metered(0.105).inspected();
  const std::string& text = checkOf(result, "line_energy").explanation;
  EXPECT_THAT(text, ::testing::ContainsRegex("by \\+5\\.[0-9]+ %; on average \\+(4\\.9|5\\.0)[0-9] %"));
}

TEST(LineEnergy, WithoutAMeterItIsInvalid) {
  auto run = metered(0.1);
  run.evidence.power_edges_s.clear();
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "line_energy").verdict, Verdict::kInvalid);
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
}

}  // namespace
}  // namespace kerfbench::inspect
