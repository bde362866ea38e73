// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "tests/hil/inspect/not_numbers.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

TEST(PathCheck, ProvesADeviationAndSaysWhere) {
  SyntheticRun run;
  run.kerf(1, kRight).calipers[80].offset_mm = -0.08;
  const auto result = run.inspected();
  const Check& path = checkOf(result, "path");
  EXPECT_EQ(path.verdict, Verdict::kFail);
  EXPECT_EQ(path.subject, "unit 1, E1");
  EXPECT_NE(path.explanation.find("to the right of the line at x 60.00, y 20.00 mm"), std::string::npos)
      << path.explanation;
  EXPECT_NEAR(path.value, 0.08, 0.005);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  for (const EntityResult& e : result.entities) {
    if (e.unit == 1 && e.entity == kRight) {
      EXPECT_NEAR(e.worst_mm, -0.08, 0.005) << "right of the line is negative";
    }
  }
}

TEST(PathCheck, AtTheLimitNothingIsProven) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[100].offset_mm = 0.051;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kNotProven);
  EXPECT_EQ(run.inspected().verdict, Verdict::kNotProven);
}

TEST(PathCheck, LeavesOutJoints) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[0].offset_mm = 0.3;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kPass);
}

TEST(PathCheck, WithoutStatedUncertaintyIsInvalid) {
  SyntheticRun run;
  run.evidence.kerf_calibration.reset();
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kInvalid);
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(Places, AreNeverShownAsMinusZero) {
  EXPECT_EQ(checks::placeOf({-0.001, -0.0049}), "x 0.00, y 0.00 mm");
  EXPECT_EQ(checks::placeOf({-0.006, 12.345}), "x -0.01, y 12.35 mm");
}

/// The width that is farthest from 0.24 mm, as measured.
double worstWidth(const SyntheticRun& run) {
  double worst_mm = 0.24;
  for (const EntityResult& e : run.inspected().entities) {
    const bool is_cut =
        run.dieline.entities[static_cast<std::size_t>(e.entity)].process == dieline::Process::kCut;
    if (is_cut && std::abs(e.width_mm - 0.24) > std::abs(worst_mm - 0.24)) worst_mm = e.width_mm;
  }
  return worst_mm;
}

TEST(OrderedWidth, IsHeldAgainstTheOrderAndNotAgainstTheOthers) {
  SyntheticRun run;
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_width").applies);
  run.limits.ordered_width = {.nominal_mm = 0.21, .limit_mm = 0.02};
  EXPECT_EQ(checkOf(run.inspected(), "ordered_width").verdict, Verdict::kPass);
  for (const double nominal_mm : {0.18, 0.24}) {
    run.limits.ordered_width.nominal_mm = nominal_mm;
    const InspectionResult result = run.inspected();
    EXPECT_EQ(checkOf(result, "ordered_width").verdict, Verdict::kFail) << nominal_mm;
    EXPECT_EQ(checkOf(result, "kerf_width").verdict, Verdict::kPass);
    EXPECT_EQ(result.verdict, Verdict::kFail);
  }
  run.limits.ordered_width.limit_mm = std::abs(worstWidth(run) - 0.24);
  run.limits.ordered_width.nominal_mm = 0.24;
  EXPECT_EQ(checkOf(run.inspected(), "ordered_width").verdict, Verdict::kNotProven);
}

/// Light through a groove's middle as a lens shows it, by a sum over its profile.
double brightnessOfGroove(double depth, double beam_mm, double lens_mm, double transmission) {
  double sum = 0.0;
  double weight = 0.0;
  for (double x_mm = -5.0 * lens_mm; x_mm <= 5.0 * lens_mm; x_mm += 0.01 * lens_mm) {
    const double w = std::exp(-0.5 * x_mm * x_mm / (lens_mm * lens_mm));
    const double at = std::min(1.0, depth * std::exp(-2.0 * x_mm * x_mm / (beam_mm * beam_mm)));
    sum += w * std::pow(transmission, 1.0 - at);
    weight += w;
  }
  return (sum / weight - transmission) / (1.0 - transmission);
}

/// A carton whose crease is `depth` deep, as the bench sees it.
SyntheticRun creased(double depth, double beam_mm = 0.105, double transmission = 0.12) {
  SyntheticRun run;
  run.evidence.beam_radius_mm = 0.105;
  const double brightness = brightnessOfGroove(depth, beam_mm, 0.02, transmission);
  for (int unit = 0; unit < 2; ++unit) {
    vision::EntityKerf& kerf = run.kerf(unit, kCreaseLine);
    kerf.middle_sigma_mm = 0.02;
    for (vision::Caliper& c : kerf.calipers) c.brightness = brightness;
  }
  return run;
}

TEST(OrderedDepth, IsHeldAgainstBothBounds) {
  SyntheticRun run = creased(0.6);
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_depth").applies);
  for (const auto& [least, most, verdict] :
       {std::tuple{0.50, 0.70, Verdict::kPass}, std::tuple{0.65, 0.90, Verdict::kFail},
        std::tuple{0.40, 0.55, Verdict::kFail}, std::tuple{0.58, 0.75, Verdict::kNotProven},
        std::tuple{0.45, 0.62, Verdict::kNotProven}}) {
    run.limits.crease_depth = {least, most};
    const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
    EXPECT_EQ(check.verdict, verdict) << check.explanation;
    EXPECT_NEAR(check.value, std::min(0.6 - least, most - 0.6), 0.002);
  }
  run.evidence.beam_radius_mm = 0.0;
  EXPECT_TRUE(unjudgedOf(run.inspected(), "ordered_depth").applies);
  run.limits.crease_depth = {};
  run.limits.half_cut_depth = {0.1, 0.2};  // The carton has no half-cut.
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_depth").applies);
}

TEST(OrderedDepth, WhatIsLeftOverAtAnEndIsNoStretchOfItsOwn) {
  // One caliper tells depth to 1 % of itself only, and the light of one may lie. Here it is the last that
  // counts, behind the last whole millimetre.
  SyntheticRun run = creased(0.6);
  const double length_mm = dieline::lengthOf(run.dieline.entities[kCreaseLine].curve);
  vision::Caliper& last =
      *std::ranges::find_if(run.kerf(0, kCreaseLine).calipers,
                            [&](const vision::Caliper& c) { return c.station_mm > length_mm - 0.6; });
  last.brightness = brightnessOfGroove(0.75, 0.105, 0.02, 0.12);
  run.limits.crease_depth = {0.5, 0.7};
  const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
}

TEST(OrderedDepth, IsWithinItsUncertaintyForAnotherBeamAndAnotherBoard) {
  for (const double depth : {0.3, 0.6, 0.8}) {
    for (const auto& [beam, transmission] :
         {std::pair{1.1, 1.0}, std::pair{0.9, 1.0}, std::pair{1.0, 1.1}, std::pair{1.0, 0.9}}) {
      SyntheticRun run = creased(depth, 0.105 * beam, 0.12 * transmission);
      // The bench reads against the grey of whole board as it is, and takes 12 % for its transmission.
      run.limits.crease_depth = {0.01, 0.99};
      const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
      EXPECT_NEAR(check.value, std::min(depth - 0.01, 0.99 - depth), 1.05 * check.u + 0.002)
          << depth << " " << beam << " " << transmission;
    }
  }
}

TEST(KerfWidthCheck, FindsTheLineThatIsWider) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.07;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "kerf_width").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "kerf_width").subject, "unit 1, E2");
}

TEST(KerfWidthCheck, NearTheLimitLooseWidthsProveNothing) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.048;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kPass);
  // The mean of 240 stations is sixteen times better than one: 3 um. A smaller deviation is hardly proven.
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_sigma_mm = 0.05;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kNotProven);
}

TEST(StrayCheck, OneOfUnknownSizeIsInvalid) {
  SyntheticRun run;
  for (const double extent_mm : {0.2, kNan, 0.3})
    run.evidence.kerf.strays.push_back({0, {33, 12}, extent_mm});
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  EXPECT_TRUE(std::isnan(checks::strayCheck(run.evidence, run.limits).value));
}

TEST(StrayCheck, AScanTellsAllThatMayBreakTheLimit) {
  constexpr double kPitch_mm = 0.04;
  Tolerances limits;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.42, 1e-12) << "one of 0.49 mm is not proven to keep 0.5";
  limits.stray_mm = 0.2;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.12, 1e-12);
  limits.stray_mm = 5.0;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.42, 1e-12) << "smaller ones are dust whatever the limit";

  SyntheticRun run;
  const double pitch_mm = run.evidence.kerf_calibration->pitchMm();
  run.evidence.kerf.strays.push_back({0, {33, 12}, 0.5 - 0.5 * pitch_mm});
  EXPECT_EQ(checkOf(run.inspected(), "stray").verdict, Verdict::kNotProven);
  run.limits.stray_mm = 0.2;
  EXPECT_EQ(checkOf(run.inspected(), "stray").verdict, Verdict::kFail);
}

TEST(StrayCheck, FailsOnWhatIsBurntBeside) {
  SyntheticRun run;
  run.evidence.kerf.strays.push_back({0, {10, 3}, 0.3});
  run.evidence.kerf.strays.push_back({1, {33, 12}, 4.2});
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stray").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(result, "stray").explanation.find("4.20 mm long, at x 33.00, y 12.00 mm of unit 1"),
            std::string::npos);
}

TEST(LaserTimingCheck, SaysThatAllEndsAreBurntWhereTheyAre) {
  // Five lines of each of two units end; the perforation and the circle do not.
  EXPECT_EQ(checkOf(SyntheticRun().inspected(), "laser_timing").explanation,
            "The kerf reaches all 20 line ends.");
}

TEST(LaserTimingCheck, FindsAStartThatIsNotBurnt) {
  SyntheticRun run;
  // A laser that is 2 ms late leaves about 0.28 mm without enough power at each start.
  unburn(run.kerf(0, kBottom).calipers[0]);
  run.kerf(0, kBottom).calipers[1].brightness = 0.2;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "laser_timing").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "laser_timing").value, 0.34, 0.02);
  EXPECT_NEAR(checkOf(result, "laser_timing").u, 0.25 * 0.25, 0.002) << "a quarter of the stations' pitch";
  EXPECT_NE(checkOf(result, "laser_timing").explanation.find("At the start of unit 0, E0"),
            std::string::npos);
}

TEST(LaserTimingCheck, AShortGapIsNoMatterOfCoverage) {
  SyntheticRun run;
  run.limits.end_gap_mm = 0.3;
  for (vision::Caliper* c :
       {&run.kerf(0, kCreaseLine).calipers.front(), &run.kerf(0, kCreaseLine).calipers.back()})
    unburn(*c);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").value, 0.0);
}

TEST(LaserTimingCheck, ACreaseBeginsWhereItHasHalfOfItsUsualLight) {
  const auto gapWith = [](double share) {
    SyntheticRun run;
    auto& calipers = run.kerf(0, kCreaseLine).calipers;
    const double usual = calipers[calipers.size() / 2].brightness;
    calipers[0].brightness = calipers[1].brightness = share * usual;
    return checkOf(run.inspected(), "laser_timing").value;
  };
  EXPECT_EQ(gapWith(0.55), 0.0);
  EXPECT_GT(gapWith(0.45), 0.1);
}

TEST(LaserTimingCheck, SeesTheGapBehindANeighboursKerf) {
  SyntheticRun run;
  // The end point itself is bright with the kerf of the adjoining line.
  auto& calipers = run.kerf(0, kTop).calipers;
  calipers[calipers.size() - 2].brightness = 0.0;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(run.inspected(), "laser_timing").explanation.find("At the end of"), std::string::npos);
}

Finding laserTimingOf(const SyntheticRun& run) {
  std::vector<EntityResult> entities;
  for (const vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    EntityResult& entity = entities.emplace_back();
    entity.unit = kerf.unit;
    entity.entity = kerf.entity;
    entity.coverage = checks::coverageOf(run.evidence, kerf, run.limits);
  }
  return checks::laserTimingCheck(run.evidence, run.limits, entities, nullptr);
}

TEST(LaserTimingCheck, ALineThatIsMostlyThereHasEnds) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kBottom).calipers;
  for (std::size_t i = 80; i < 176; ++i) unburn(calipers[i]);  // 40 %
  unburn(calipers[0]);
  calipers[1].brightness = 0.2;
  const Finding check = laserTimingOf(run);
  EXPECT_EQ(check->verdict, Verdict::kFail);
  EXPECT_EQ(check->subject, "unit 0, E0");
}

TEST(LaserTimingCheck, DoesNotApplyWhereNoLineEnds) {
  SyntheticRun run;
  for (dieline::Entity& entity : run.dieline.entities) {
    if (entity.id <= kLeft || entity.id == kCreaseLine) entity.process = dieline::Process::kPerforation;
  }
  const Finding check = laserTimingOf(run);
  ASSERT_FALSE(check);
  EXPECT_FALSE(check.why().applies);
}

TEST(LaserTimingCheck, AHalfLitEndIsNoGap) {
  SyntheticRun run;
  // At the tip of a slit the end point gets half of the line's energy.
  run.kerf(0, kBottom).calipers[0].brightness = 0.4;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kPass);
}

TEST(LongestStretch, IsAsLongAtTheStartOfALineAsAnywhere) {
  constexpr std::size_t kStations = 20;
  constexpr double kPitch_mm = 0.25;
  const auto lengthFrom = [&](std::size_t first) {
    std::vector<vision::Caliper> calipers(kStations);
    std::vector<const vision::Caliper*> stations;
    for (std::size_t i = 0; i < kStations; ++i) {
      calipers[i].station_mm = kPitch_mm * static_cast<double>(i);
      calipers[i].brightness = i >= first && i < first + 3 ? 0.0 : 1.0;
      stations.push_back(&calipers[i]);
    }
    return checks::longestStretch(stations, [](const vision::Caliper& c) { return c.brightness < 0.5; })
        .length_mm;
  };
  // Three dark stations, and the light of half a pitch to each side on which there is one.
  EXPECT_NEAR(lengthFrom(8), 3.0 * kPitch_mm, 1e-12);
  EXPECT_NEAR(lengthFrom(0), 2.5 * kPitch_mm, 1e-12);
  EXPECT_NEAR(lengthFrom(1), 3.0 * kPitch_mm, 1e-12);
  EXPECT_NEAR(lengthFrom(kStations - 3), 2.5 * kPitch_mm, 1e-12);
}

TEST(LongestStretch, CountsEveryStationOfALineThatLacksPartOfItsLight) {
  std::vector<vision::Caliper> calipers(9);
  std::vector<const vision::Caliper*> stations;
  for (std::size_t i = 0; i < calipers.size(); ++i) {
    calipers[i].station_mm = 0.25 * static_cast<double>(i);
    calipers[i].brightness = 0.45;
    stations.push_back(&calipers[i]);
  }
  // From the first to the last, less what the two calipers reach beyond a piece at least.
  const auto dim = [](const vision::Caliper& c) { return c.brightness < 0.5; };
  EXPECT_NEAR(checks::longestStretch(stations, dim).length_mm, 2.0 - 0.1, 1e-12);
}

}  // namespace
}  // namespace kerfbench::inspect
