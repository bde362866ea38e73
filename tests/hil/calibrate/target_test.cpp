// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/camera/target_print.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/camera/twin/views/twin_views.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::calibrate {
namespace {

using testing::HasSubstr;

CalibrationTarget targetOfSize(int columns, int rows) { return {columns, rows, 5.0, 3.0}; }

TEST(CalibrationTarget, EveryWhiteSquareHasAMarkerOfItsOwn) {
  for (const auto& [columns, rows] : {std::pair(4, 4), std::pair(7, 6), std::pair(6, 7), std::pair(9, 5)}) {
    const CalibrationTarget target = targetOfSize(columns, rows);
    std::set<int> seen;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const int marker = target.markerIn(column, row);
        EXPECT_EQ(marker >= 0, (column + row) % 2 == 1);
        if (marker < 0) continue;
        EXPECT_TRUE(seen.insert(marker).second);
        EXPECT_EQ(target.squareOf(marker), Eigen::Vector2i(column, row)) << marker;
      }
    }
    EXPECT_EQ(static_cast<int>(seen.size()), target.markers());
    EXPECT_EQ(*seen.rbegin(), target.markers() - 1);
  }
  EXPECT_EQ(targetOfSize(4, 4).markerIn(-1, 0), -1);
  EXPECT_THROW((void)targetOfSize(4, 4).squareOf(8), std::out_of_range);
}

TEST(CalibrationTarget, NamesEveryFault) {
  EXPECT_EQ(targetOfSize(9, 7).faults(), "");
  const CalibrationTarget bad{3, 300, -1.0, 9.0};
  for (const char* word : {"columns", "rows", "square_mm", "marker_mm"})
    EXPECT_THAT(bad.faults(), HasSubstr(word));
  EXPECT_THAT(targetOfSize(60, 60).faults(), HasSubstr("1800 markers, 1000 at most"));
}

TEST(CalibrationTarget, FitsAField) {
  for (const double scale : {0.01, 1.0, 37.0}) {
    const Eigen::Vector2d field_mm = scale * Eigen::Vector2d(180.0, 120.0);
    const CalibrationTarget target = targetFor(field_mm, 0.1, scale * 2.0);
    EXPECT_EQ(target.faults(), "") << scale;
    EXPECT_GE(target.size_mm().x(), 1.2 * field_mm.x() - 1e-9);
    EXPECT_GE(target.size_mm().y(), 1.2 * field_mm.y() - 1e-9);
    EXPECT_GE(target.square_mm, scale * 2.0);
  }
}

TEST(TargetFiles, ADescriptionComesBackAsItWas) {
  const base::TempFolder temp;
  const CalibrationTarget target{12, 9, 4.0371, 2.4113};
  const CalibrationTarget read = readTarget(temp.write("t.yaml", targetText(target)));
  EXPECT_EQ(read.columns, target.columns);
  EXPECT_EQ(read.rows, target.rows);
  EXPECT_EQ(read.square_mm, target.square_mm);
  EXPECT_EQ(read.marker_mm, target.marker_mm);
  EXPECT_THROW((void)readTarget(temp.write("u.yaml",
                                           "version: 1\ncolumns: 12\nrows: 9\nsquare_mm: .nan\n"
                                           "marker_mm: 2\n")),
               base::ConfigError);
  EXPECT_THROW((void)readTarget(temp.write("v.yaml",
                                           "version: 1\ncolumns: 60\nrows: 60\nsquare_mm: 5\n"
                                           "marker_mm: 3\n")),
               base::ConfigError);
}

TEST(TargetFiles, ThePrintIsWhatTheTwinShowsAndTheBenchLooksFor) {
  const CalibrationTarget target{6, 5, 5.0, 3.0};
  const std::string svg = targetSvg(target);
  // Each "M x y h w v h h -w z" is a black rectangle.
  struct Box {
    double x, y, width, height;
  };
  std::vector<Box> boxes;
  const std::regex rectangle(R"(M(\S+) (\S+)h(\S+)v(\S+)h(\S+)z)");
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), rectangle); it != std::sregex_iterator(); ++it)
    boxes.push_back({std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4])});
  const twin::TargetPattern pattern(camera::boardOf(target));
  int black = 0;
  for (double y = 0.0317; y < 25.0; y += 0.1101) {
    for (double x = 0.0317; x < 30.0; x += 0.1101) {
      const bool printed = std::ranges::any_of(
          boxes, [&](const Box& b) { return x > b.x && x < b.x + b.width && y > b.y && y < b.y + b.height; });
      EXPECT_EQ(printed, pattern.grayAt({x, y}) < 100.0) << x << " " << y;
      black += printed ? 1 : 0;
    }
  }
  EXPECT_GT(black, 10000);
  EXPECT_THAT(svg, HasSubstr("width=\"50mm\" height=\"45mm\" viewBox=\"-10 -10 50 45\""));
  EXPECT_THAT(svg, HasSubstr("The line is 20 mm long."));
  EXPECT_THAT(svg, HasSubstr("6 x 5 squares of 5 mm"));
}

}  // namespace
}  // namespace kerfbench::calibrate
