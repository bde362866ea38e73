// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/spline_row.h"

#include <gtest/gtest.h>

#include <vector>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr int kColumns = 40, kRows = 30;

TEST(SplineRow, HasTheValuesOfTheSplinePlaceByPlace) {
  const CounterRandom random(1, 2);
  std::vector<float> nodes(kColumns * kRows);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = static_cast<float>(random.uniform(i));
  RowValues x, y, values;
  for (std::size_t i = 0; i < kMostInRow; ++i) {
    x[i] = static_cast<float>(1.0 + (kColumns - 3.001) * random.uniform(5000 + i));
    y[i] = static_cast<float>(1.0 + (kRows - 3.001) * random.uniform(6000 + i));
  }
  const SplineWeightTable weights;
  splineValues({nodes.data(), kColumns}, weights, x, y, kMostInRow, values);
  for (std::size_t i = 0; i < kMostInRow; ++i) {
    const int column = static_cast<int>(x[i]);
    const int row = static_cast<int>(y[i]);
    EXPECT_EQ(values[i], splineValue(nodes.data() + (row - 1) * kColumns + column - 1, kColumns,
                                     weights.at(x[i] - static_cast<float>(column)),
                                     weights.at(y[i] - static_cast<float>(row))));
  }
}

TEST(SplineRow, AddsTheShareOfALineThatIsAboveZero) {
  const RowValues from{-1.0F, 1.0F, -1.0F, 3.0F, 0.0F, 0.0F};
  const RowValues to{-2.0F, 2.0F, 3.0F, -1.0F, -1.0F, 1.0F};
  RowValues sums;
  sums.fill(10.0F);
  addAboveZero(from, to, 2.0F, 6, sums);
  EXPECT_EQ(sums[0], 10.0F);
  EXPECT_EQ(sums[1], 12.0F);
  EXPECT_EQ(sums[2], 11.5F);
  EXPECT_EQ(sums[3], 11.5F);
  EXPECT_EQ(sums[4], 10.0F);
  EXPECT_EQ(sums[5], 12.0F);
}

}  // namespace
}  // namespace kerfbench::twin
