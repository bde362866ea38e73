// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/cor_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kHalf_mm = 50.0;
constexpr double kScale = 655.36;

AimGrid seeded(std::uint64_t seed, Between between = Between::kBilinear, std::size_t nodes = 65) {
  const auto places = evenly(-kHalf_mm, kHalf_mm, nodes);
  return SeededHead(seed, kHalf_mm).table(places, places, between);
}

std::vector<CorConvention> conventions() {
  std::vector<CorConvention> all;
  for (unsigned bits = 0; bits < 32; ++bits) {
    CorConvention c;
    c.first = (bits & 1U) != 0 ? CorConvention::First::kDx : CorConvention::First::kDy;
    c.fast = (bits & 2U) != 0 ? CorConvention::Fast::kX : CorConvention::Fast::kY;
    c.sense = (bits & 4U) != 0 ? CorConvention::Sense::kAdd : CorConvention::Sense::kSubtract;
    c.x_descends = (bits & 8U) != 0;
    c.y_descends = (bits & 16U) != 0;
    c.units_per_mm = kScale;
    all.push_back(c);
  }
  return all;
}

TEST(CorFile, WrittenAndReadIsTheSameCorrectionInEveryConvention) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const AimGrid grid = seeded(seed);
    for (const CorConvention& convention : conventions()) {
      const CorFile v1 = parseCorFile(corFile(grid, CorVersion::k1, convention), "a.cor", convention);
      EXPECT_EQ(v1.version, CorVersion::k1);
      EXPECT_LT(farthest_mm(grid, v1.grid), 1e-12);
      const CorFile v2 = parseCorFile(corFile(grid, CorVersion::k2, convention), "a.cor", convention);
      EXPECT_EQ(v2.version, CorVersion::k2);
      const double half_a_unit_mm = 0.5 / kScale * std::sqrt(2.0);
      EXPECT_LT(farthest_mm(grid, v2.grid), half_a_unit_mm * (1 + 1e-9));
    }
  }
}

TEST(CorFile, TheScaleIsTheFilesOwn) {
  CorConvention convention;
  convention.units_per_mm = kScale;
  const std::string bytes = corFile(seeded(1), CorVersion::k2, convention);
  const CorFile read = parseCorFile(bytes, "a.cor");
  EXPECT_EQ(read.units_per_mm, kScale);
  EXPECT_NEAR(read.grid.area_W_mm().max().x(), kHalf_mm, 1e-9);
}

TEST(CorFile, BytesLieWhereOthersLookForThem) {
  CorConvention convention = CorConvention::added();
  convention.units_per_mm = kScale;
  const AimGrid grid = seeded(4);
  const auto number = [](const std::string& bytes, std::size_t at, auto value) {
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  const std::string v1 = corFile(grid, CorVersion::k1, convention);
  EXPECT_EQ(v1.size(), 68128U);
  EXPECT_EQ(v1.substr(0, 4), std::string("L\0M\0", 4));
  EXPECT_EQ(number(v1, 0x18 + 43 * 8, double{}), kScale);
  EXPECT_EQ(number(v1, 0x210, double{}), kScale * grid.d_mm(0, 0).x());
  EXPECT_EQ(number(v1, 0x210 + 16, double{}), kScale * grid.d_mm(1, 0).x());
  const std::string v2 = corFile(grid, CorVersion::k2, convention);
  EXPECT_EQ(v2.size(), 33840U);
  EXPECT_EQ(v2.substr(0, 12), std::string("JCZ_COR_2_1\0", 12));
  EXPECT_EQ(number(v2, 28, double{}), kScale);
  EXPECT_EQ(number(v2, 36 + 4, std::int32_t{}), std::lround(kScale * grid.d_mm(0, 0).y()));
  EXPECT_EQ(number(v2, 36 + 65 * 8, std::int32_t{}), std::lround(kScale * grid.d_mm(0, 1).x()));
}

// The layout of glase: for ix, for iy, {dy, dx} of the error of the point, a meaningless scale, four bytes
// more.
TEST(CorFile, ReadsAFileMadeByGlasesRecipe) {
  const SeededHead head(7, 80);
  std::string bytes = "JCZ_COR_2_1";
  bytes.resize(28, '\0');
  bytes += "\xc0\x01\xca\xfe\xbe\xef\xf0\x0d";
  const auto put = [&](double mm) {
    const auto value = static_cast<std::int32_t>(400 * mm);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int i = -32; i <= 32; ++i) {
    for (int j = -32; j <= 32; ++j) {
      const Eigen::Vector2d p(2.5 * i, 2.5 * j);
      const Eigen::Vector2d wrong = p - head.aimFor(p);
      put(wrong.y());
      put(wrong.x());
    }
  }
  bytes += std::string("\x07\0\0\0", 4);
  const CorFile file = parseCorFile(bytes, "local.fixup.cor", CorConvention::glase());
  EXPECT_NEAR(file.grid.area_W_mm().max().y(), 80.0, 1e-9);
  const AimGrid& grid = file.grid;
  for (std::size_t row = 0; row < 65; ++row) {
    for (std::size_t column = 0; column < 65; ++column) {
      const Eigen::Vector2d p(grid.x_mm()[column], grid.y_mm()[row]);
      EXPECT_LT((head.spotFor(p + grid.d_mm(column, row)) - p).norm(), 2.0 * 1.5 / 400);
    }
  }
  CorConvention unscaled = CorConvention::glase();
  unscaled.units_per_mm.reset();
  EXPECT_NE(
      faultsOf([&] { (void)parseCorFile(bytes, "a.cor", unscaled); }).find("a.cor: byte 28: the scale of"),
      std::string::npos);
}

TEST(CorFile, LabelsOfBothWidthsAreKnown) {
  CorConvention convention;
  convention.units_per_mm = kScale;
  std::string bytes = corFile(seeded(1), CorVersion::k1, convention);
  bytes.replace(0, 22, std::string("LMC1COR_1.0") + std::string(11, '\0'));
  EXPECT_EQ(parseCorFile(bytes, "a.cor").version, CorVersion::k1);
}

TEST(CorFile, WhatTheBoardCannotHoldIsRefusedWithItsPlace) {
  const auto places = evenly(-50, 50, 3);
  const AimGrid grid(places, places, std::vector<Eigen::Vector2d>(9, {0, 51}), Between::kBilinear,
                     Outside::kRefused);
  CorConvention convention;
  convention.units_per_mm = kScale;
  try {
    (void)corFile(grid, CorVersion::k2, convention);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "-33423 units at (-50, -50) mm are beyond ±32767");
  }
  EXPECT_THROW((void)corFile(grid, CorVersion::k2, CorConvention{}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::calibrate
