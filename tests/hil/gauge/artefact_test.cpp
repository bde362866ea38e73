// SPDX-License-Identifier: Apache-2.0
// Truth that gauge measures against, by geometry that is independent of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/dieline/geometry.h"
#include "hil/gauge/case_plan.h"
#include "hil/gauge/cut.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

constexpr double kRadius_mm = 0.105;

ArtefactBeam plainBeam() {
  twin::MachineDescription machine;
  machine.kind = twin::MachineDescription::Kind::kGantry;
  machine.beam.waist_radius_mm = kRadius_mm;
  return {machine, Vector2d::Zero()};
}

std::vector<vision::EntityKerf> stationsOfAll(double pitch_mm) {
  std::vector<vision::EntityKerf> kerfs;
  for (const dieline::Entity& e : gaugeArtefact().dieline.entities) {
    vision::EntityKerf& kerf = kerfs.emplace_back();
    kerf.entity = e.id;
    const double length_mm = dieline::lengthOf(e.curve);
    for (const double u : dieline::stations(e.curve, pitch_mm)) {
      vision::Caliper& c = kerf.calipers.emplace_back();
      c.u = u;
      c.station_mm = u * length_mm;
      c.p_S_mm = dieline::pointAt(e.curve, u);
    }
  }
  return kerfs;
}

CutTruth truthOf(const std::vector<Fault>& faults) {
  const ArtefactBeam beam = plainBeam();
  return ArtefactCut(gaugeArtefact(), faults, beam, 1).truth(stationsOfAll(0.1), {}, kRadius_mm);
}

/// Ridge of the burn: the place across a station, along the left normal, where the sheet absorbed most
/// energy.
double ridge_mm(const twin::Sheet& sheet, const dieline::Curve& curve, double u) {
  const Vector2d p = dieline::pointAt(curve, u);
  const Vector2d t = dieline::tangentAt(curve, u);
  const Vector2d n(-t.y(), t.x());
  // The place is the centre of gravity of the profile above half of its top, refined by a parabola through
  // the logarithm.
  double best = 0.0;
  double most = -1.0;
  for (int i = -300; i <= 300; ++i) {
    const double d = 0.001 * i;
    const double f = sheet.fluenceAt(p + d * n);
    if (f > most) {
      most = f;
      best = d;
    }
  }
  constexpr double kH = 0.03;
  const auto log_at = [&](double d) { return std::log(sheet.fluenceAt(p + d * n)); };
  const double a = log_at(best - kH);
  const double b = log_at(best);
  const double c = log_at(best + kH);
  return best + 0.5 * kH * (a - c) / (a - 2.0 * b + c);
}

TEST(GaugeTruth, IsWhereTheEnergyLiesOnTheSheet) {
  for (const FaultKind kind : {FaultKind::kOffset, FaultKind::kBump, FaultKind::kScale, FaultKind::kRotation,
                               FaultKind::kEntity, FaultKind::kWave}) {
    Fault fault = drawFault(kind, 0.06, gaugeArtefact(), 3);
    if (kind == FaultKind::kWave) fault.length_mm = 6.0;
    const ArtefactBeam beam = plainBeam();
    const ArtefactCut cut(gaugeArtefact(), {fault}, beam, 1);
    twin::Sheet sheet({});
    cut.burn(sheet, kRadius_mm);
    const std::vector<vision::EntityKerf> kerfs = stationsOfAll(0.5);
    const CutTruth truth = cut.truth(kerfs, {}, kRadius_mm);
    for (std::size_t k = 0; k < kerfs.size(); ++k) {
      const dieline::Entity& entity = gaugeArtefact().dieline.entities[k];
      const double length_mm = dieline::lengthOf(entity.curve);
      for (std::size_t i = 0; i < kerfs[k].calipers.size(); ++i) {
        const vision::Caliper& c = kerfs[k].calipers[i];
        const bool at_corner =
            (k == static_cast<std::size_t>(gaugeArtefact().corner_in) && length_mm - c.station_mm < 0.4) ||
            (k == static_cast<std::size_t>(gaugeArtefact().corner_out) && c.station_mm < 0.4);
        if (at_corner) continue;
        EXPECT_NEAR(truth.entities[k].offset_mm[i], ridge_mm(sheet, entity.curve, c.u), 0.0003)
            << faultName(kind) << ", E" << k << " at " << c.station_mm;
      }
    }
  }
}

TEST(GaugeTruth, OfAPerfectCutIsTheBendOfTheCurveAlone) {
  const CutTruth truth = truthOf({});
  for (const EntityTruth& e : truth.entities) {
    const dieline::Entity& entity = gaugeArtefact().dieline.entities[static_cast<std::size_t>(e.entity)];
    const auto* arc = std::get_if<dieline::ArcCurve>(&entity.curve);
    const double inside_mm = arc == nullptr ? 0.0 : kRadius_mm * kRadius_mm / (8.0 * arc->radius_mm);
    EXPECT_NEAR(e.worst_mm, inside_mm, 1e-5) << e.entity;
  }
  EXPECT_NEAR(truth.entities[static_cast<std::size_t>(gaugeArtefact().circle)].circularity_mm, 0.0, 2e-6);
  EXPECT_NEAR(truth.worstJoint_mm(), 0.0, 1e-12);
}

TEST(GaugeTruth, OfAnOffsetIsItsPartAcrossEachLine) {
  const CutTruth truth = truthOf({{.kind = FaultKind::kOffset, .size_mm = 0.05, .direction_rad = 0.3}});
  EXPECT_NEAR(truth.entities[0].worst_mm, 0.05 * std::sin(0.3), 1e-9);  // E0 runs along x.
  EXPECT_NEAR(truth.entities[1].worst_mm, 0.05 * std::cos(0.3), 1e-9);  // E1 runs along y.
  EXPECT_NEAR(truth.worst_mm, 0.05, 7e-4);  // The circle shows all of it, and 0.6 um of its bend.
}

TEST(GaugeTruth, OfAnEndIsItsGapAndTouchesNoLine) {
  for (const double size_mm : {0.08, -0.08}) {
    const CutTruth truth =
        truthOf({{.kind = FaultKind::kEnd, .size_mm = size_mm, .entity = 1, .at_start = true}});
    EXPECT_LT(truth.worst_mm, 1e-3);
    for (const CutTruth::End& end : truth.ends)
      EXPECT_NEAR(end.gap_mm, end.entity == 1 && end.at_start ? size_mm : 0.0, 1e-12);
  }
}

TEST(GaugeTruth, OfACornerIsRoundingOrOvershoot) {
  EXPECT_NEAR(truthOf({{.kind = FaultKind::kCorner, .size_mm = 0.07}}).rounding_mm, 0.07, 1e-12);
  EXPECT_NEAR(truthOf({{.kind = FaultKind::kCorner, .size_mm = 0.07}}).overshoot_mm, 0.0, 1e-12);
  EXPECT_NEAR(truthOf({{.kind = FaultKind::kCorner, .size_mm = -0.07}}).overshoot_mm, 0.07, 1e-12);
}

TEST(GaugeTruth, OfACornerThatIsDisplacedIsNeitherRoundingNorOvershootButADeviation) {
  const Fault offset{.kind = FaultKind::kOffset, .size_mm = 0.05, .direction_rad = 0.25 * std::numbers::pi};
  const CutTruth displaced = truthOf({offset});
  EXPECT_NEAR(displaced.rounding_mm, 0.0, 1e-9);
  EXPECT_NEAR(displaced.overshoot_mm, 0.0, 1e-9);
  EXPECT_NEAR(displaced.corner_mm, 0.05, 1e-4);  // The corner moves outwards, along the bisector.
  const CutTruth rounded = truthOf({{.kind = FaultKind::kCorner, .size_mm = 0.07}, offset});
  EXPECT_NEAR(rounded.rounding_mm, 0.07, 1e-4);
  EXPECT_LT(rounded.corner_mm, 0.05);
  const CutTruth run_over = truthOf({{.kind = FaultKind::kCorner, .size_mm = -0.07}, offset});
  EXPECT_NEAR(run_over.overshoot_mm, 0.07, 1e-9);
  EXPECT_GT(run_over.corner_mm, 0.1);
}

TEST(GaugeTruth, OfAScaledCircleIsNoLackOfRoundness) {
  const CutTruth truth = truthOf({{.kind = FaultKind::kScale, .size_mm = 0.08}});
  // The circle's middle is shifted by 40 um: the deviation normal to the nominal circle is then not quite one
  // harmonic.
  EXPECT_LT(truth.entities[static_cast<std::size_t>(gaugeArtefact().circle)].circularity_mm, 4e-4);
}

TEST(GaugeTruth, OfAWaveIsTwiceItsAmplitudeInRoundness) {
  // The circle has three waves or more, so that neither its radius nor its centre takes part in them.
  const CutTruth truth = truthOf({{.kind = FaultKind::kWave, .size_mm = 0.04, .length_mm = 3.0}});
  EXPECT_NEAR(truth.entities[static_cast<std::size_t>(gaugeArtefact().circle)].circularity_mm, 0.08, 8e-4);
}

TEST(GaugeArtefact, NothingIsNearerToAnotherLineThanTheJudgeCanTellApart) {
  const auto& entities = gaugeArtefact().dieline.entities;
  for (const dieline::Entity& a : entities) {
    for (const dieline::Entity& b : entities) {
      const bool corner = std::min(a.id, b.id) == gaugeArtefact().corner_in &&
                          std::max(a.id, b.id) == gaugeArtefact().corner_out;
      if (a.id == b.id || corner) continue;
      for (const double u : dieline::stations(a.curve, 0.2))
        EXPECT_GT(dieline::nearestOn(b.curve, dieline::pointAt(a.curve, u)).distance_mm, 1.5)
            << a.id << " and " << b.id;
    }
  }
}

TEST(GaugeCase, IsFoundAgainByItsName) {
  for (const char* name : {"static-bad-17", "dynamic-good-0", "ideal-coverage-999", "static-stillrepeat-3"}) {
    const auto id = caseFromName(name);
    ASSERT_TRUE(id) << name;
    EXPECT_EQ(nameOf(*id), name);
  }
  for (const char* name : {"", "static", "static-bad", "static-bad-", "static-bad--1", "static-bad-1x",
                           "odd-bad-1", "static-odd-1", "-bad-1", "static--1"})
    EXPECT_FALSE(caseFromName(name)) << name;
}

}  // namespace
}  // namespace kerfbench::gauge
