// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "hil/calibrate/marks/field_marks.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/camera/twin/twin_tiles.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::calibrate::test {

/// A sheet with marks that the model's beam burns at the places of a head with errors, and its pictures.
struct MarkedSheet {
  MarkJob job;
  twin::CameraDescription camera = vision::test::kerfCamera();
  twin::BoardDescription board{.thickness_mm = 1e-6};  ///< So thin that it looks the same from all sides.
  /// Place where the beam lands that is aimed at p_S.
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> head = [](const Eigen::Vector2d& p) { return p; };
  std::set<std::pair<int, int>> skipped;  ///< Strokes left out: number of the mark; 0 … 3 arms, 4 … ticks.
  std::function<void(MarkedSheet&, twin::Sheet&)> also;  ///< Burns further things onto the sheet.
  std::uint64_t seed{1};
  double share{1.5};  ///< Fluence in the middle of a line, relative to the one that cuts through.
  int threads{2};

  /// Makes a sheet with columns x rows marks of 5 mm, 6.25 mm apart, with print around them.
  MarkedSheet(int columns, int rows, int first_number = 0);

  void burn(twin::Sheet& sheet, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) const;
  /// Burns marks of the job, through the head.
  void burnMarks(twin::Sheet& sheet) const;
  [[nodiscard]] std::vector<camera::KerfTile> tiles();
  [[nodiscard]] FieldPictures find();
  [[nodiscard]] FieldPictures find(std::vector<camera::KerfTile> some) const;
  [[nodiscard]] MarkedField match() { return matchField(job, find()); }
};

}  // namespace kerfbench::calibrate::test
