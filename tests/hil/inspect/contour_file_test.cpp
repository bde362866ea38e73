// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/contour_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"

namespace kerfbench::inspect {
namespace {

std::string contourFaults(const std::string& text) {
  try {
    (void)readContourFile(text, "c.xyz");
  } catch (const base::InputError& e) {
    return e.what();
  }
  return "";
}

TEST(ContourFile, PointsHaveTheirPlacesAxesAndLines) {
  const auto points = readContourFile("# a box\n0 0 0  0 0 1\n\n30, 10, 0  0 0 1 ; end\n", "c.xyz");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].p_W_mm, Eigen::Vector3d(30.0, 10.0, 0.0));
  EXPECT_EQ(points[1].axis_W, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(points[1].file_line, 4);
}

TEST(ContourFile, EveryFaultIsToldWithItsLine) {
  const std::string faults =
      contourFaults("0 0 0 0 0 1\n0 0 0 0 0 1\n1 2 3\n1 2 x 0 0 1\n4 4 4 0 0 2\nvia 1 2 3\n1 2 inf 0 0 1\n");
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:2: the point is the one before"));
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:3: 3 words"));
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:4: 'x' is no number"));
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:5: the axis has the length 2.0000"));
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:6: 'via'"));
  EXPECT_THAT(faults, testing::HasSubstr("c.xyz:7: 'inf' is no number"));
}

TEST(ContourFile, AContourHasTwoPointsAtLeast) {
  EXPECT_THAT(contourFaults("0 0 0 0 0 1\n"), testing::HasSubstr("two points or more"));
}

}  // namespace
}  // namespace kerfbench::inspect
