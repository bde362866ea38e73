// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_grid.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

TEST(SampleGrid, FindsAllThatLieWithinACell) {
  constexpr double kCellMm = 0.9;
  const CounterRandom random(3, 1);
  // The places lie about the origin: cells of negative number, too.
  const auto place = [&](std::uint64_t i) {
    return Vector2d(8.0 * random.uniform(2 * i) - 4.0, 8.0 * random.uniform(2 * i + 1) - 4.0);
  };
  SampleGrid grid(kCellMm);
  std::vector<Vector2d> all;
  for (std::size_t i = 0; i < 600; ++i) {
    all.push_back(place(i));
    grid.add({all.back(), Vector2d::UnitX(), 0.0, 0.0, i});
  }
  for (std::uint64_t k = 0; k < 200; ++k) {
    const Vector2d p_mm = place(1000 + k);
    std::set<std::size_t> found;
    grid.around(p_mm, [&](const CurveSample& sample) {
      EXPECT_TRUE(found.insert(sample.plan).second) << "told twice";
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
      if ((all[i] - p_mm).norm() <= kCellMm) {
        EXPECT_TRUE(found.contains(i)) << p_mm.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace kerfbench::vision
