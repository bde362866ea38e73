// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/recognise.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "hil/calibrate/tables/cor_file.h"
#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2i;
using Eigen::Vector2d;
using Verdict = Recognition::Verdict;

constexpr double kHalf_mm = 50.0;

AimGrid tableOf(const SeededHead& head) {
  return head.table(evenly(-kHalf_mm, kHalf_mm, 65), evenly(-kHalf_mm, kHalf_mm, 65), Between::kBilinear);
}

/// Table of a head that lands at lands(aim), at a contraction's distance from the aim.
AimGrid tableThatUndoes(const auto& lands) {
  const auto places = evenly(-kHalf_mm, kHalf_mm, 65);
  std::vector<Vector2d> d;
  for (const double y : places) {
    for (const double x : places) {
      const Vector2d p(x, y);
      Vector2d aim = p;
      for (int i = 0; i < 200; ++i) aim += p - lands(aim);
      d.emplace_back(aim - p);
    }
  }
  return {places, places, d, Between::kBilinear, Outside::kRefused};
}

std::vector<UncorrectedSpot> nineSpotsOf(const auto& lands) {
  std::vector<UncorrectedSpot> spots;
  for (const int row : {-1, 0, 1}) {
    for (const int column : {-1, 0, 1}) {
      const Vector2d aim(40.0 * column, 40.0 * row);
      spots.push_back({aim, lands(aim)});
    }
  }
  return spots;
}

/// Reading that cancels another: d = V⁻¹ d'(A ·).
TableReading inverse(const TableReading& reading) {
  return {reading.places.transpose(), reading.values.transpose()};
}

TEST(Recognise, TellsAllSixtyFourReadingsOfAHeadWithoutSymmetry) {
  EXPECT_EQ(allReadings().size(), 64U);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SeededHead head(seed, kHalf_mm);
    const AimGrid right = tableOf(head);
    for (const TableReading& reading : allReadings()) {
      const Recognition found = recognise(asRead(right, inverse(reading)), head.nineSpots(0.02, seed));
      ASSERT_EQ(found.verdict, reading == TableReading{} ? Verdict::kAsRead : Verdict::kOtherwise)
          << seed << ": " << reading.text() << ": " << found.text;
      ASSERT_EQ(found.reading, reading) << seed << ": " << reading.text() << ": " << found.text;
      ASSERT_LT(found.fits.front().rms_mm, 0.06);
    }
  }
}

TEST(Recognise, TheReadingFoundMendsTheTable) {
  const SeededHead head(3, kHalf_mm);
  const AimGrid right = tableOf(head);
  for (const TableReading& reading : allReadings()) {
    const AimGrid mended = asRead(asRead(right, inverse(reading)), reading);
    EXPECT_LT(farthest_mm(right, mended), 1e-9) << reading.text();
  }
}

TEST(Recognise, ACorFileReadWithTheWrongConventionIsToldInWords) {
  const SeededHead head(11, kHalf_mm);
  CorConvention true_one;
  true_one.units_per_mm = 655.36;
  const std::string bytes = corFile(tableOf(head), CorVersion::k2, true_one);
  const auto heard = [&](CorConvention convention) {
    return recognise(parseCorFile(bytes, "a.cor", convention).grid, head.nineSpots()).text;
  };
  EXPECT_TRUE(heard({}).starts_with("the file is as it was read: 0.0"));
  CorConvention c;
  c.sense = CorConvention::Sense::kAdd;
  EXPECT_TRUE(heard(c).starts_with("the sign is turned: "));
  c = {};
  c.first = CorConvention::First::kDx;
  EXPECT_TRUE(heard(c).starts_with("the values are exchanged, dx for dy: "));
  c.fast = CorConvention::Fast::kX;
  EXPECT_TRUE(heard(c).starts_with("the file is transposed: "));
  c.sense = CorConvention::Sense::kAdd;
  EXPECT_TRUE(heard(c).starts_with("the file is transposed, and its sign is turned: ")) << heard(c);
  c = {};
  c.x_descends = true;
  EXPECT_TRUE(heard(c).starts_with("the order of the nodes is mirrored in x: ")) << heard(c);
  EXPECT_NE(heard(c).find("read as it is, "), std::string::npos);
}

TEST(Recognise, AFileMirroredAsAWholeIsCalledThat) {
  Matrix2i mirror;
  mirror << -1, 0, 0, 1;
  const SeededHead head(2, kHalf_mm);
  const Recognition found = recognise(asRead(tableOf(head), {mirror, mirror}), head.nineSpots());
  EXPECT_TRUE(found.text.starts_with("the file is mirrored in x: ")) << found.text;
}

// A head that is the same on all sides gives equal mirrored files: no reason to refuse one.
TEST(Recognise, ReadingsThatAreTheSameTableAreNoRivals) {
  const auto pincushion = [](const Vector2d& a) -> Vector2d { return a * (1 + 1e-5 * a.squaredNorm()); };
  const AimGrid grid = tableThatUndoes(pincushion);
  const std::vector<UncorrectedSpot> spots = nineSpotsOf(pincushion);
  EXPECT_EQ(recognise(grid, spots).verdict, Verdict::kAsRead);
  const TableReading turned{Matrix2i::Identity(), -Matrix2i::Identity()};
  const Recognition found = recognise(asRead(grid, turned), spots);
  EXPECT_EQ(found.verdict, Verdict::kOtherwise);
  EXPECT_TRUE(found.text.starts_with("the sign is turned")) << found.text;
}

// The head is nearly the same on both sides of an axis: the readings differ by less than the noise of a
// ruler.
TEST(Recognise, SaysWhenItCannotBeTold) {
  const auto bowed = [](const Vector2d& a) -> Vector2d {
    return {a.x() * (1 + 2e-5 * a.y() * a.y()) + 0.0003 * a.y(), a.y() * (1 + 1e-5 * a.y() * a.y())};
  };
  const AimGrid grid = tableThatUndoes(bowed);
  const std::vector<UncorrectedSpot> spots = nineSpotsOf(bowed);
  const Recognition by_ruler = recognise(grid, spots, {.sigma_mm = 0.1});
  EXPECT_EQ(by_ruler.verdict, Verdict::kUndecided);
  EXPECT_TRUE(by_ruler.text.starts_with("cannot be told: «the file is as it was read» leaves 0.0"))
      << by_ruler.text;
  EXPECT_NE(by_ruler.text.find("mirrored"), std::string::npos) << by_ruler.text;
  EXPECT_EQ(recognise(grid, spots, {.sigma_mm = 0.001}).verdict, Verdict::kAsRead);
}

TEST(Recognise, ATableOfAnotherHeadFitsInNoReading) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Recognition found = recognise(tableOf(SeededHead(seed, kHalf_mm)),
                                        SeededHead(seed + 100, kHalf_mm).nineSpots(0.02, seed));
    EXPECT_EQ(found.verdict, Verdict::kNoneFits) << found.text;
  }
}

TEST(Recognise, ZerosAndHeadsWithoutErrorTellNothing) {
  const SeededHead straight(1, kHalf_mm, 0.0);
  EXPECT_EQ(recognise(tableOf(straight), straight.nineSpots(0.02, 1)).verdict, Verdict::kAsRead);
  const Recognition bowed_table = recognise(tableOf(SeededHead(1, kHalf_mm)), straight.nineSpots());
  EXPECT_EQ(bowed_table.verdict, Verdict::kNoneFits) << bowed_table.text;
}

TEST(Recognise, RefusesWhatItCannotUse) {
  const SeededHead head(1, kHalf_mm);
  const AimGrid grid = tableOf(head);
  EXPECT_THROW((void)recognise(grid, head.nineSpots(), {.sigma_mm = 0.0}), std::invalid_argument);
  auto spots = head.nineSpots();
  spots[3].spot_W_mm.x() = NAN;
  EXPECT_THROW((void)recognise(grid, spots), std::invalid_argument);
  spots.resize(3);
  EXPECT_THROW((void)recognise(grid, spots), std::invalid_argument);
  EXPECT_THROW((void)recognise(grid, SeededHead(1, 200).nineSpots()), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::calibrate
