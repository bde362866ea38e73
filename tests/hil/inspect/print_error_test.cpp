// SPDX-License-Identifier: Apache-2.0
// What misprinted marks do to places on the sheet, held against a fit to such marks.
#include "hil/inspect/evidence/print_error.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "hil/inspect/inspect.h"
#include "hil/vision/marks/constellation.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;
using namespace testing;

PrintLayout fourMarks() {
  PrintLayout print;
  for (const double x : {-5.0, 65.0})
    for (const double y : {-5.0, 45.0}) print.marks.push_back({{x, y + 0.1 * x}, 3.0});
  return print;
}

/// Where a place is reported by a fit to marks that lie elsewhere than the layout says.
Vector2d reported(const PrintLayout& print, const std::vector<std::size_t>& seen,
                  const std::vector<Vector2d>& errors_mm, const Vector2d& p_S_mm) {
  std::vector<vision::MarkPair> pairs;
  for (const std::size_t i : seen)
    pairs.push_back({print.marks[i].p_SM_mm, print.marks[i].p_SM_mm + errors_mm[i], 0.0});
  return vision::fitMotion(pairs, 0.0) * p_S_mm;
}

TEST(PrintError, IsThatOfAFitToMisprintedMarks) {
  const PrintLayout print = fourMarks();
  const std::vector<Vector2d> errors_mm{{0.003, -0.001}, {-0.002, 0.002}, {0.001, 0.004}, {-0.001, -0.003}};
  for (const auto& seen : std::vector<std::vector<std::size_t>>{{0, 1, 2, 3}, {0, 1}, {1, 2, 3}, {3, 0}}) {
    for (const Vector2d& p_S_mm : {Vector2d(0.0, 0.0), Vector2d(60.0, 10.0), Vector2d(-30.0, 80.0)}) {
      Eigen::VectorXd all = Eigen::VectorXd::Zero(8);
      for (std::size_t i = 0; i < 4; ++i) all.segment<2>(2 * static_cast<Eigen::Index>(i)) = errors_mm[i];
      const Vector2d moved = printInfluence(print, seen, p_S_mm) * all;
      EXPECT_LT((moved - (reported(print, seen, errors_mm, p_S_mm) - p_S_mm)).norm(), 1e-6);
    }
  }
}

TEST(PrintError, OfOneMarkIsItsOwnAndOfNoneIsNothing) {
  const PrintLayout print = fourMarks();
  Eigen::Matrix2Xd one = printInfluence(print, {2}, {30.0, 7.0});
  EXPECT_EQ(one.middleCols<2>(4), Eigen::Matrix2d::Identity());
  one.middleCols<2>(4).setZero();
  EXPECT_EQ(one.norm(), 0.0);
  EXPECT_EQ(printInfluence(print, {}, {30.0, 7.0}).norm(), 0.0);
}

/// U of the largest drift where the frames of each cut see these marks first and those later.
double driftU_mm(double print_sigma_mm, const std::vector<std::size_t>& first,
                 const std::vector<std::size_t>& later) {
  SyntheticRun run;
  run.evidence.print_sigma_mm = print_sigma_mm;
  for (std::size_t i = 0; i < run.evidence.spot.frames.size(); ++i) {
    for (vision::SheetPose& pose : run.evidence.spot.frames[i].sheet) pose.seen = i % 40 < 20 ? first : later;
  }
  return checkOf(run.inspected(), "stillness_x").u;
}

TEST(PrintError, IsAStepOfTheSheetWhereOtherMarksComeIntoView) {
  const double without = driftU_mm(0.0, {0, 1}, {2, 3});
  EXPECT_NEAR(driftU_mm(0.005, {0, 1, 2, 3}, {0, 1, 2, 3}), without, 0.2 * without) << "the same all along";
  EXPECT_GT(driftU_mm(0.02, {0, 1}, {2, 3}), without + 0.005);
}

TEST(PrintError, WidensSpotPathAndMakesNoFrameFaint) {
  SyntheticRun run;
  const auto most_mm = [&] {
    const auto result = run.inspected();
    const Check& check = checkOf(result, "spot_path");
    EXPECT_NE(check.verdict, Verdict::kInvalid);
    return check.value + check.u;
  };
  const double without_mm = most_mm();
  run.evidence.print_sigma_mm = 0.01;
  EXPECT_GT(most_mm(), without_mm + 0.005);
}

}  // namespace
}  // namespace kerfbench::inspect
