// SPDX-License-Identifier: Apache-2.0
// What is stated of a table after marks verified it, against heads whose errors are known exactly.
#include "hil/calibrate/head/verified_table.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "hil/calibrate/head/correction_table.h"
#include "hil/calibrate/head/stated_spread.h"
#include "tests/hil/calibrate/head/simulated_head.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using test::Beyond;
using test::HeadKind;
using test::SimulatedHead;

constexpr double kMark_mm = 2e-4;
constexpr std::uint64_t kSheetErrors = 1, kMarkErrors = 2, kPlaces = 3;

/// Marks of a sheet at these places, cut with the table or without; the sheet lies a little off its place.
std::vector<HeadObservation> cut(const SimulatedHead& head, const std::vector<Vector2d>& places,
                                 const AimGrid* table, int sheet, std::uint64_t seed) {
  const CounterRandom of_sheet(seed, kSheetErrors), of_mark(seed, kMarkErrors);
  const auto first = 3 * static_cast<std::uint64_t>(sheet);
  const Eigen::Vector3d off(of_sheet.normal(first), of_sheet.normal(first + 1), of_sheet.normal(first + 2));
  std::vector<HeadObservation> marks;
  for (const Vector2d& p : places) {
    const Vector2d aim = table != nullptr ? Vector2d(p + table->at_mm(p).value()) : p;
    SharedError shared{sheet, {}};
    shared.modes_mm << 5e-4, 0.0, -2e-6 * p.y(), 0.0, 3e-4, 2e-6 * p.x();
    const auto index = 2000 * static_cast<std::uint64_t>(sheet) + 2 * marks.size();
    const Vector2d noise(of_mark.normal(index), of_mark.normal(index + 1));
    marks.push_back({static_cast<int>(marks.size()), aim,
                     head.spotFor(aim, false) + kMark_mm * noise + shared.modes_mm * off,
                     kMark_mm * kMark_mm * Eigen::Matrix2d::Identity(), shared});
  }
  return marks;
}

std::vector<Vector2d> gridOf(const Eigen::AlignedBox2d& field, int n) {
  std::vector<Vector2d> places;
  for (int i = 0; i < n * n; ++i)
    places.emplace_back(
        field.min() + Vector2d(1.0 * (i % n) / (n - 1), 1.0 * (i / n) / (n - 1)).cwiseProduct(field.sizes()));
  return places;
}

/// Places anywhere, one in eight of them on the rim, as `calibrate head` spreads them.
std::vector<Vector2d> anywhere(const Eigen::AlignedBox2d& field, std::uint64_t count, std::uint64_t seed) {
  const CounterRandom where(seed, kPlaces);
  std::vector<Vector2d> places;
  for (std::uint64_t i = 0; i < count; ++i) {
    Vector2d share(where.uniform(2 * i), where.uniform(2 * i + 1));
    if (i % 8 == 0) share[static_cast<int>(i / 8 % 2)] = i / 16 % 2 == 0 ? 0.0 : 1.0;
    places.emplace_back(field.min() + share.cwiseProduct(field.sizes()));
  }
  return places;
}

/// A head, fitted to n x n marks by data sheets that allow this, its table, and marks that verify it.
struct Calibrated {
  Calibrated(HeadKind kind, Beyond beyond, int n, double unmodelled_share, std::uint64_t seed)
      : head(kind, beyond, seed), fit(fitOf(n, unmodelled_share, seed)), table(tableOf()) {
    for (int sheet = 1; sheet <= 2; ++sheet) {
      for (const HeadObservation& o :
           cut(head, anywhere(head.field_W_mm(), 100, 10 * seed + static_cast<std::uint64_t>(sheet)), &table,
               sheet, seed))
        marks.push_back(o);
    }
  }

  HeadFit fitOf(int n, double unmodelled_share, std::uint64_t seed) const {
    HeadFitOptions options;
    options.field_W_mm = head.field_W_mm();
    options.round_steps = false;
    options.tolerances.unmodelled_share = unmodelled_share;
    return fitHead(cut(head, gridOf(head.field_W_mm(), n), nullptr, 0, seed), head.nominal(), head.design(),
                   options);
  }
  AimGrid tableOf() const {
    CorrectionTableOptions options;
    options.field_W_mm = head.field_W_mm();
    return correctionTable(fit, options).grid;
  }
  VerifiedTable verified() const { return verifiedTable(fit, table, head.field_W_mm(), marks); }
  /// The truth, between the places where verifiedTable() looks, too.
  double largest_mm() const {
    double most = 0.0;
    for (const Vector2d& p : gridOf(head.field_W_mm(), 41))
      most = std::max(most, (head.spotFor(p + table.at_mm(p).value(), false) - p).norm());
    return most;
  }

  SimulatedHead head;
  HeadFit fit;
  AimGrid table;
  std::vector<HeadObservation> marks;
};

/// Whether a share of 95 % gives `hits` of `all` with a chance above 1 % (two-sided, by the normal).
testing::AssertionResult isNinetyFivePercent(std::size_t hits, std::size_t all) {
  const auto n = static_cast<double>(all);
  const double off = (static_cast<double>(hits) - 0.95 * n) / std::sqrt(0.95 * 0.05 * n);
  if (std::abs(off) <= 2.576) return testing::AssertionSuccess();
  return testing::AssertionFailure() << hits << " of " << all << " are "
                                     << 100.0 * static_cast<double>(hits) / n << " %, " << off
                                     << " sigmas off";
}

/// A kind of head and what the fit is told of it: the default is 30 µm of 300 mm, where there is nothing at
/// all or the errors of analogue encoders; others are told too little.
struct Told {
  HeadKind kind;
  Beyond beyond;
  int n;
  double unmodelled_share;
  double widest_mm;          ///< Beyond any U of the largest error.
  double least_within{0.9};  ///< Share of the heads whose largest error lies within U.
  bool followed{true};       ///< Marks follow what the head does from place to place.
  bool fit_alone{false};     ///< The ellipse of the fit alone holds 95 % as well.
  int heads{20};
};
class VerifiedTables : public testing::TestWithParam<Told> {};

TEST_P(VerifiedTables, HoldNinetyFivePercentOfThePlacesAndTheTrueLargestError) {
  const Told& told = GetParam();
  std::size_t covered = 0, places = 0, by_fit = 0, within = 0;
  double widest = 0.0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(told.heads); ++seed) {
    const Calibrated calibrated(told.kind, told.beyond, told.n, told.unmodelled_share, seed);
    const VerifiedTable verified = calibrated.verified();
    covered += verified.covered;
    places += verified.marks;
    by_fit += statedSpread(calibrated.fit, calibrated.marks).covered;
    const double off = calibrated.largest_mm() - verified.largest.value_mm;
    within += std::abs(off) <= verified.largest.U_mm ? 1 : 0;
    widest = std::max(widest, verified.largest.U_mm);
  }
  if (told.followed) EXPECT_TRUE(isNinetyFivePercent(covered, places));
  EXPECT_GE(static_cast<double>(covered), 0.93 * static_cast<double>(places));
  EXPECT_GE(within, told.least_within * told.heads);
  EXPECT_LT(widest, told.widest_mm);
  // Tolerances alone let the fit state too much or too little of such heads.
  EXPECT_EQ(static_cast<bool>(isNinetyFivePercent(by_fit, places)), told.fit_alone);
}
INSTANTIATE_TEST_SUITE_P(
    Heads, VerifiedTables,
    testing::Values(Told{HeadKind::kTwoMirror300, Beyond::kNothing, 3, 1e-4, 0.001},
                    Told{HeadKind::kTwoMirror300, Beyond::kNothing, 3, 1e-6, 0.001},
                    Told{HeadKind::kTwoMirror300, Beyond::kBentBoard, 3, 1e-5, 0.001},
                    Told{HeadKind::kTwoMirror300, Beyond::kAnalogue, 3, 1e-4, 0.004},
                    // A wave of the encoders that 81 marks do not follow, and 200 at random places hardly.
                    Told{HeadKind::kTwoMirror300, Beyond::kAnalogue, 9, 1e-4, 0.002, 0.8, false},
                    Told{HeadKind::kFTheta300, Beyond::kNothing, 3, 1e-4, 0.001},
                    Told{HeadKind::kFTheta300, Beyond::kNothing, 9, 1e-4, 0.001}));

TEST(VerifiedTable, WithoutMarksIsWhatTheFitSays) {
  const Calibrated wide(HeadKind::kTwoMirror300, Beyond::kNothing, 3, 1e-4, 1);
  const Calibrated narrow(HeadKind::kTwoMirror300, Beyond::kNothing, 3, 1e-6, 1);
  const LargestError by_default = verifiedTable(wide.fit, wide.table, wide.head.field_W_mm(), {}).largest;
  const LargestError by_data_sheet =
      verifiedTable(narrow.fit, narrow.table, narrow.head.field_W_mm(), {}).largest;
  EXPECT_GT(by_default.value_mm + by_default.U_mm, 2.0 * (by_data_sheet.value_mm + by_data_sheet.U_mm));
  EXPECT_GT(by_default.value_mm + by_default.U_mm, wide.largest_mm());
  // Marks then tell the same of both.
  EXPECT_NEAR(wide.verified().largest.value_mm, wide.largest_mm(), wide.verified().largest.U_mm);
  EXPECT_NEAR(narrow.verified().largest.value_mm, narrow.largest_mm(), narrow.verified().largest.U_mm);
}

TEST(VerifiedTable, AMarkThatLiesAsideStandsForItselfAndForNoOther) {
  Calibrated calibrated(HeadKind::kTwoMirror300, Beyond::kNothing, 9, 1e-4, 3);
  const VerifiedTable before = calibrated.verified();
  EXPECT_EQ(before.disagreeing, 0U);
  calibrated.marks[17].measured_W_mm.x() += 0.3;
  const VerifiedTable after = calibrated.verified();
  EXPECT_EQ(after.disagreeing, 1U);
  EXPECT_NEAR(after.largest.value_mm, 0.3, 0.002);
  EXPECT_LT(after.largest.U_mm, 0.002);
  EXPECT_NEAR((after.largest.p_W_mm - calibrated.marks[17].measured_W_mm).norm(), 0.3, 0.002);
  EXPECT_NEAR(after.mark_factor, before.mark_factor, 0.05);
}

// Quantiles by an independent sum in whole numbers: scipy.stats.binom.ppf([0.005, 0.995], n, 0.95).
TEST(VerifiedTable, SaysHowManyOfSoManyAnEllipseOfNinetyFivePercentHolds) {
  EXPECT_EQ(coverBand(400).least, 368U);
  EXPECT_EQ(coverBand(400).most, 390U);
  EXPECT_EQ(coverBand(20).least, 16U);
  EXPECT_EQ(coverBand(20).most, 20U);
  VerifiedTable table;
  table.marks = table.covered = 400;
  EXPECT_FALSE(table.coverHolds());
  table.covered = 380;
  EXPECT_TRUE(table.coverHolds());
}

TEST(VerifiedTable, RefusesAFieldThatTheTableDoesNotReach) {
  const Calibrated calibrated(HeadKind::kTwoMirror300, Beyond::kNothing, 3, 1e-4, 1);
  const Eigen::AlignedBox2d wide(Vector2d::Constant(-200.0), Vector2d::Constant(200.0));
  EXPECT_THROW(verifiedTable(calibrated.fit, calibrated.table, wide, calibrated.marks), HeadCalibrationError);
}

TEST(HeadFit, ItsErrorsByWhereTheyComeFromAddUpToItsCovariance) {
  for (const int n : {3, 9}) {
    const Calibrated calibrated(HeadKind::kTwoMirror300, Beyond::kAnalogue, n, 1e-4, 2);
    for (const Vector2d& aim : {Vector2d(-140.0, 30.0), Vector2d(10.0, 90.0)}) {
      const HeadFit::ErrorModes modes = calibrated.fit.errorModesAt(aim).value();
      const Eigen::Matrix2d sum = modes.by_marks_mm * modes.by_marks_mm.transpose() +
                                  modes.by_tolerances_mm * modes.by_tolerances_mm.transpose() +
                                  modes.by_surface_mm * modes.by_surface_mm.transpose();
      EXPECT_TRUE(sum.isApprox(calibrated.fit.covarianceAt_mm2(aim).value(), 1e-6)) << n;
      // No more errors by the marks than these have coordinates.
      EXPECT_LE(modes.by_marks_mm.cols(), 2 * n * n);
    }
  }
}

}  // namespace
}  // namespace kerfbench::calibrate
