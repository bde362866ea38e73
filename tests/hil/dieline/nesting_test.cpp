// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/outlines.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using ::testing::ElementsAre;

struct Round {
  double x_mm, y_mm, r_mm;
};

Outlines outlinesOfCircles(const std::vector<Round>& circles) {
  std::string svg =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">)";
  svg += R"(<g id="Cut" stroke="#000000">)";
  for (const Round& circle : circles)
    svg +=
        fmt::format(R"(<circle fill="none" cx="{}" cy="{}" r="{}"/>)", circle.x_mm, circle.y_mm, circle.r_mm);
  return outlinesOf(readText(".svg", svg + "</g></svg>"), Process::kCut);
}

/// True if the first is wholly inside of the second.
bool isWithin(const Round& inner, const Round& outer) {
  return std::hypot(inner.x_mm - outer.x_mm, inner.y_mm - outer.y_mm) + inner.r_mm < outer.r_mm;
}
bool areApart(const Round& a, const Round& b) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm) > a.r_mm + b.r_mm;
}

TEST(Nesting, CountsTheOutlinesAroundEachOne) {
  // A piece within a hole within a piece, and beside it one whose box alone reaches around another.
  const std::vector<Round> circles{{30, 30, 20}, {30, 30, 10}, {30, 30, 5}, {75, 75, 15}, {88, 88, 2}};
  EXPECT_THAT(nestingsOf(outlinesOfCircles(circles)), ElementsAre(0, 1, 2, 0, 0));
}

TEST(Nesting, AgreesWithTheCirclesThemselves) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(5.0, 95.0);
  std::uniform_real_distribution<double> exponent(-1.0, 1.5);
  std::vector<Round> circles;
  for (int tries = 0; tries < 4000; ++tries) {
    const Round next{place(random), place(random), std::pow(10.0, exponent(random))};
    bool is_free = true;
    for (const Round& other : circles)
      is_free = is_free && (areApart(next, other) || isWithin(next, other) || isWithin(other, next));
    if (is_free) circles.push_back(next);
  }
  const std::vector<int> nestings = nestingsOf(outlinesOfCircles(circles));
  ASSERT_EQ(nestings.size(), circles.size());
  int deepest = 0;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    int around = 0;
    for (const Round& other : circles) around += isWithin(circles[i], other) ? 1 : 0;
    EXPECT_EQ(nestings[i], around) << i;
    deepest = std::max(deepest, around);
  }
  EXPECT_GE(deepest, 3);
  EXPECT_GE(circles.size(), 300U);
}

TEST(Outlines, JoinsTheEndsThatMeetAndNoOthers) {
  // Chains of lines with random gaps around the limit, on a lattice, so that columns of ends are full.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> gap(-0.03, 0.03);
  std::string lines =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">)";
  std::size_t joints = 0;
  for (int row = 0; row < 40; ++row) {
    double x_mm = 1.0;
    double y_mm = 1.0 + 2.0 * row;
    for (int i = 0; i < 40; ++i) {
      lines += fmt::format(R"(<path fill="none" stroke="#000000" d="M{:.9f} {:.9f} L{:.9f} {:.9f}"/>)", x_mm,
                           y_mm, x_mm + 2.0, y_mm);
      const double dx_mm = gap(random);
      const double dy_mm = gap(random);
      if (i < 39 && std::hypot(dx_mm, dy_mm) <= kEndsMeet_mm) ++joints;
      x_mm += 2.0 + dx_mm;
      y_mm += dy_mm;
    }
  }
  const Outlines outlines = outlinesOf(readText(".svg", lines + "</svg>"), Process::kCut);
  EXPECT_TRUE(outlines.closed.empty());
  EXPECT_TRUE(outlines.branchings.empty());
  EXPECT_EQ(outlines.open.size(), 1600U - joints);
  EXPECT_GT(joints, 300U);
}

}  // namespace
}  // namespace kerfbench::dieline
