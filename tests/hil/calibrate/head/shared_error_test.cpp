// SPDX-License-Identifier: Apache-2.0
// Error that all marks of a sheet share: its place is known by its printed marks, to some tenths of a
// micrometre, and all its marks are off by that error.
#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/LU>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/quick_check.h"
#include "tests/hil/calibrate/head/simulated_head.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using test::Beyond;
using test::HeadKind;
using test::SimulatedHead;

constexpr double kEllipse95 = 5.991464547107979;  // Quantile of chi-square with two degrees of freedom.
constexpr double kMark_mm = 2e-4;
constexpr std::uint64_t kSheetErrors = 1, kMarkErrors = 2;

/// Error with which a camera of 30 µm a pixel places a sheet: shift x, y (mm), turn (rad).
const Eigen::Vector3d kPose(5e-4, 3e-4, 2e-6);

/// Observations of n x n marks of a sheet that lies a little off its assumed place; the mirrors stand
/// exactly.
std::vector<HeadObservation> sheetOf(const SimulatedHead& head, int n, int sheet, std::uint64_t seed,
                                     const Eigen::Vector3d& pose = kPose) {
  const CounterRandom of_sheet(seed, kSheetErrors), of_mark(seed, kMarkErrors);
  const auto first = 3 * static_cast<std::uint64_t>(sheet);
  const Eigen::Vector3d off(of_sheet.normal(first), of_sheet.normal(first + 1), of_sheet.normal(first + 2));
  std::vector<HeadObservation> marks;
  for (int i = 0; i < n * n; ++i) {
    const Vector2d share(static_cast<double>(i % n) / (n - 1), static_cast<double>(i / n) / (n - 1));
    const Vector2d aim = head.field_W_mm().min() + share.cwiseProduct(head.field_W_mm().sizes());
    SharedError shared{sheet, {}};
    shared.modes_mm << pose.x(), 0.0, -aim.y() * pose.z(), 0.0, pose.y(), aim.x() * pose.z();
    const auto index = 2000 * static_cast<std::uint64_t>(sheet) + 2 * static_cast<std::uint64_t>(i);
    const Vector2d noise(of_mark.normal(index), of_mark.normal(index + 1));
    marks.push_back({i, aim, head.spotFor(aim, false) + kMark_mm * noise + shared.modes_mm * off,
                     kMark_mm * kMark_mm * Eigen::Matrix2d::Identity(), shared});
  }
  return marks;
}

/// Observations with the sheet's error as an independent error of each mark.
std::vector<HeadObservation> asIndependent(std::vector<HeadObservation> marks) {
  for (HeadObservation& o : marks) {
    o.covariance_mm2 = o.wholeCovariance_mm2();
    o.shared.reset();
  }
  return marks;
}

HeadFit fitOfShared(const SimulatedHead& head, const std::vector<HeadObservation>& marks) {
  HeadFitOptions options;
  options.field_W_mm = head.field_W_mm();
  options.round_steps = false;
  options.tolerances.unmodelled_share = head.unmodelledShare();
  return fitHead(marks, head.nominal(), head.design(), options);
}

std::vector<HeadObservation> twoSheets(const SimulatedHead& head, std::uint64_t seed) {
  std::vector<HeadObservation> marks = sheetOf(head, 3, 0, seed);
  for (const HeadObservation& o : sheetOf(head, 9, 1, seed)) marks.push_back(o);
  return marks;
}

/// Counts places whose error lies in the stated 95 % ellipse.
struct Cover {
  int within{}, places{};
  void count(const SimulatedHead& head, const HeadFit& fit) {
    for (const Vector2d& aim :
         {Vector2d(-120, 70), Vector2d(20, 10), Vector2d(140, 130), Vector2d(60, -145)}) {
      const Vector2d off = head.spotFor(aim, false) - fit.spotOf(aim)->p_W_mm;
      within += off.dot(fit.covarianceAt_mm2(aim)->inverse() * off) <= kEllipse95 ? 1 : 0;
      ++places;
    }
  }
  [[nodiscard]] double share() const { return static_cast<double>(within) / places; }
};

TEST(SharedError, TheFitStatesWhatTheSheetsPlacesAreWorth) {
  Cover shared, independent;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, seed);
    const std::vector<HeadObservation> marks = twoSheets(head, seed);
    shared.count(head, fitOfShared(head, marks));
    if (seed <= 100) independent.count(head, fitOfShared(head, asIndependent(marks)));
  }
  EXPECT_GT(shared.share(), 0.94);
  EXPECT_LT(shared.share(), 0.97);
  EXPECT_LT(independent.share(), 0.8);
}

// As noise of each mark a shift of all would hide how little the marks scatter against each other.
TEST(SharedError, IsNoScatterOfTheMarks) {
  const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, 11);
  const std::vector<HeadObservation> marks = twoSheets(head, 11);
  EXPECT_NEAR(fitOfShared(head, marks).noiseRatio(), 1.0, 0.15);
  EXPECT_LT(fitOfShared(head, asIndependent(marks)).noiseRatio(), 0.7);
}

TEST(SharedError, AFalseMarkIsSeenBesideTheOthersOfItsSheet) {
  const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, 12);
  // The sheet was placed by hand: all marks are off, by the same amount.
  const Eigen::Vector3d loose(0.05, 0.05, 1e-4);
  std::vector<HeadObservation> marks = sheetOf(head, 9, 0, 12);
  for (HeadObservation& o : sheetOf(head, 9, 1, 12, loose)) marks.push_back(o);
  marks[100].measured_W_mm.x() += 0.004;
  const HeadFit fit = fitOfShared(head, marks);
  for (std::size_t i = 0; i < marks.size(); ++i) EXPECT_EQ(fit.marks()[i].used, i != 100) << i;
  EXPECT_GT(fit.marks()[100].residual_mm.x(), 0.003);
}

TEST(SharedError, ASheetThatLiesAsideIsNoDriftOfTheHead) {
  const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, 13);
  const HeadFit fit = fitOfShared(head, twoSheets(head, 13));
  const Eigen::Vector3d coarse(0.005, 0.005, 1e-5);
  int alarms = 0, alarms_if_independent = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const std::vector<HeadObservation> nine = sheetOf(head, 3, 2, 1000 + seed, coarse);
    alarms += quickCheck(fit, nine).holds ? 0 : 1;
    alarms_if_independent += quickCheck(fit, asIndependent(nine)).holds ? 0 : 1;
  }
  EXPECT_LE(alarms, 6);
  EXPECT_GT(alarms_if_independent, 12);
}

}  // namespace
}  // namespace kerfbench::calibrate
