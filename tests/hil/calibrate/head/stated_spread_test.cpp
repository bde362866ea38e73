// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/stated_spread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/hil/calibrate/head/campaign.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using test::Beyond;
using test::HeadKind;
using test::SimulatedHead;
using testing::HasSubstr;

constexpr double kMark_mm = 3e-4;
constexpr int kSheets = 2, kSide = 4;

HeadFit fitOf(const SimulatedHead& head, int n) {
  const test::MarkedSheet sheet = test::mark(head, n, 0, nullptr, {}, 1);
  HeadFitOptions options;
  options.field_W_mm = head.field_W_mm();
  options.tolerances.unmodelled_share = head.unmodelledShare();
  return fitHead(pairMarks(sheet.aimed, sheet.seen).observations, head.nominal(), head.design(), options);
}

/// Marks on sheets of their own, off by a sample of the stated uncertainty of fit, sheet and mark, times a
/// factor.
std::vector<HeadObservation> drawn(const HeadFit& fit, const Eigen::AlignedBox2d& field_W_mm,
                                   std::uint64_t seed, double factor) {
  const CounterRandom of_fit(seed, 1), of_sheet(seed, 2), of_mark(seed, 3);
  std::vector<HeadObservation> marks;
  for (int sheet = 0; sheet < kSheets; ++sheet) {
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vector2d share((0.3 + i % kSide) / kSide, (0.6 + i / kSide) / kSide);
      const Vector2d aim = field_W_mm.min() + share.cwiseProduct(field_W_mm.sizes());
      const Eigen::Matrix2Xd modes = fit.modesAt(aim).value();
      Vector2d off = Vector2d::Zero();
      for (Eigen::Index k = 0; k < modes.cols(); ++k)
        off += of_fit.normal(static_cast<std::uint64_t>(k)) * modes.col(k);
      SharedError shared{sheet, {}};
      shared.modes_mm << 5e-4, 0.0, -2e-6 * aim.y(), 0.0, 3e-4, 2e-6 * aim.x();
      for (int k = 0; k < 3; ++k)
        off += of_sheet.normal(static_cast<std::uint64_t>(3 * sheet + k)) * shared.modes_mm.col(k);
      const auto number = static_cast<std::uint64_t>(2 * marks.size());
      off += kMark_mm * Vector2d(of_mark.normal(number), of_mark.normal(number + 1));
      marks.push_back({static_cast<int>(marks.size()), aim, fit.spotOf(aim)->p_W_mm + factor * off,
                       kMark_mm * kMark_mm * Eigen::Matrix2d::Identity(), shared});
    }
  }
  return marks;
}

struct Draws {
  double mean_square{}, covered{}, against{}, most_ratio{};
};

Draws drawsOf(const HeadFit& fit, const Eigen::AlignedBox2d& field_W_mm, double factor, int draws) {
  Draws all;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(draws); ++seed) {
    const StatedSpread spread = statedSpread(fit, drawn(fit, field_W_mm, seed, factor));
    const double square = spread.ratio * spread.ratio;
    all.mean_square += square / draws;
    all.covered += static_cast<double>(spread.covered) / static_cast<double>(spread.marks) / draws;
    all.against += (spread.holds() ? 0.0 : 1.0) / draws;
    all.most_ratio = spread.most_ratio;
  }
  return all;
}

// The uncertainty of nine marks is mostly that of a few errors that all places share, that of 81 the marks'
// own.
TEST(StatedSpread, OneInAHundredSpeaksAgainstWhatIsTrueAndMostAgainstWhatIsNot) {
  for (const int n : {3, 9}) {
    const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, 5);
    const HeadFit fit = fitOf(head, n);
    const Draws honest = drawsOf(fit, head.field_W_mm(), 1.0, 2000);
    EXPECT_NEAR(honest.mean_square, 1.0, 0.03) << n;
    EXPECT_NEAR(honest.covered, 0.95, 0.01) << n;
    EXPECT_GT(honest.against, 0.004) << n;
    EXPECT_LT(honest.against, 0.02) << n;
    EXPECT_LT(drawsOf(fit, head.field_W_mm(), 0.5, 200).against, 0.001) << n;
    EXPECT_GT(drawsOf(fit, head.field_W_mm(), 3.0, 200).against, 0.9) << n;
    EXPECT_LT(honest.most_ratio, n == 3 ? 2.2 : 1.8) << n;
    EXPECT_GT(honest.most_ratio, n == 3 ? 1.5 : 1.1) << n;
  }
}

TEST(StatedSpread, TellsInWordsAndOfNothingNothing) {
  const SimulatedHead head(HeadKind::kTwoMirror300, Beyond::kNothing, 5);
  const HeadFit fit = fitOf(head, 9);
  EXPECT_TRUE(statedSpread(fit, {}).holds());
  EXPECT_EQ(statedSpread(fit, {}).marks, 0U);
  std::vector<HeadObservation> marks = drawn(fit, head.field_W_mm(), 1, 1.0);
  for (HeadObservation& o : marks) o.measured_W_mm.x() += 0.1;
  const StatedSpread spread = statedSpread(fit, marks);
  EXPECT_FALSE(spread.holds());
  EXPECT_EQ(spread.covered, 0U);
  EXPECT_THAT(spread.words(), HasSubstr("times as far as stated, where chance reaches 1."));
}

}  // namespace
}  // namespace kerfbench::calibrate
