// SPDX-License-Identifier: Apache-2.0
// What is measured against what is true: the severed edge on the model's own sheet, on the face as it stands.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hil/fold/fold_scenario.h"
#include "hil/fold/fold_twin.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::fold {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Truth at a reading: components of the vector from the contour's line to the edge.
struct TrueEdge {
  double beside_mm{}, above_mm{};
};

/// The edge of the severed kerf across the line, between its middle and the piece, by bisection.
TrueEdge trueEdge(const FoldScenario& scenario, const twin::FoldedCut& cut,
                  const inspect::EdgeReading& reading) {
  const inspect::SpaceLine& line = scenario.job.lines[reading.line];
  const twin::Sheet& sheet = cut.sheets[line.face];
  const Vector2d at = line.from_F_mm + reading.way_mm * line.along_F;
  double inside_mm = scenario.job.kerf_radius_mm;
  double outside_mm = -scenario.job.kerf_radius_mm;
  for (int i = 0; i < 40; ++i) {
    const double middle_mm = 0.5 * (inside_mm + outside_mm);
    (sheet.depthAt(at + middle_mm * line.beside_F) >= 1.0 ? inside_mm : outside_mm) = middle_mm;
  }
  const Vector2d edge_F = at + inside_mm * line.beside_F;
  const Vector3d edge_W = scenario.blank.standing[line.face].X_WF * Vector3d(edge_F.x(), edge_F.y(), 0.0);
  const Eigen::Isometry3d& drawn = scenario.job.faces[line.face].X_WF;
  const Vector3d off_F = drawn.inverse() * edge_W - Vector3d(at.x(), at.y(), 0.0);
  return {off_F.head<2>().dot(line.beside_F), off_F.z()};
}

TEST(FoldTruth, ReadingsAndTheWorstOfThemAreAsGoodAsTheyState) {
  const base::TempFolder temp;
  int all = 0;
  int beyond = 0;
  for (const int seed : {11, 12, 13, 14}) {
    const FoldScenario scenario = readFoldScenario(
        temp.write("s.yaml", fmt::format("extends: '{}'\nname: s\nseed: {}\n",
                                         base::fixture("fold/shallow-edge.yaml").string(), seed)));
    const twin::FoldedCut cut = cutOnTwin(scenario);
    TwinFoldCameras cameras(scenario, cut, 1);
    const FoldJudgement judgement = judgeFold(scenario.job, scenario.contour, instrumentsOf(scenario, 1),
                                              scenario.limits, cameras, scenario.seed);
    double worst_mm = 0.0;
    for (const inspect::EdgeReading& reading : judgement.result.readings) {
      if (reading.zone != inspect::EdgeZone::kAlong || !reading.found) continue;
      const TrueEdge truth = trueEdge(scenario, cut, reading);
      worst_mm = std::max(worst_mm, std::hypot(truth.beside_mm, truth.above_mm));
      const double beside_U =
          2.0 * std::hypot(reading.noise_mm, inspect::sharedU_mm(reading, Vector2d::UnitX()));
      const double above_U = 2.0 * inspect::sharedU_mm(reading, Vector2d::UnitY());
      all += 2;
      if (std::abs(reading.beside_mm - truth.beside_mm) > beside_U) ++beyond;
      if (std::abs(reading.above_mm - truth.above_mm) > above_U) ++beyond;
    }
    const inspect::Quantity& stated = judgement.result.worst.value;
    EXPECT_LE(std::abs(worst_mm - stated.value), stated.U) << "seed " << seed;
  }
  EXPECT_GT(all, 3000);
  EXPECT_LT(beyond, all / 10);
}

}  // namespace
}  // namespace kerfbench::fold
