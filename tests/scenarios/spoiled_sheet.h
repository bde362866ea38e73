// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "hil/calibrate/marks/field_marks.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/tile_source.h"
#include "hil/head_service/head_setup.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::test {

/// Pictures of a sheet of field marks as `calibrate head --keep-pictures` wrote them, to be spoiled and
/// written elsewhere. A change of a mark applies to every picture that shows it.
class SpoiledSheet {
 public:
  /// Reads a sheet. @param sheet with marks.yaml and pictures/.
  SpoiledSheet(const std::filesystem::path& sheet, const head_service::HeadSetup& setup);

  [[nodiscard]] std::size_t size() const { return tiles_.size(); }
  [[nodiscard]] std::vector<int> numbers() const;
  /// Erases a mark, as if it had never been cut: board from next to it.
  void erase(int number);
  /// Cuts a mark once more, displaced.
  void again(int number, const Eigen::Vector2d& by_mm);
  /// Moves a mark.
  void move(int number, const Eigen::Vector2d& by_mm);
  /// Erases all print of the board.
  void erasePrint();
  /// Changes any picture, counted from 0.
  void change(std::size_t tile, const std::function<void(cv::Mat&)>& how);
  void changeAll(const std::function<void(cv::Mat&)>& how);
  /// Shifts the stated place of the camera.
  void shift(std::size_t tile, const Eigen::Vector2d& by_mm) { tiles_.at(tile).p_TV_mm += by_mm; }

  /// Writes all pictures and tiles.yaml.
  void write(const std::filesystem::path& folder) const;

 private:
  using Edit = std::function<void(cv::Mat& picture, const cv::Mat& before, const cv::Rect& box)>;
  void edit(const Eigen::Vector2d& p_S_mm, double half_mm, const Edit& how);
  void erase(const Eigen::Vector2d& p_S_mm, double half_mm);
  void paste(int number, const Eigen::Vector2d& by_mm, const std::vector<camera::KerfTile>& from);
  [[nodiscard]] Eigen::Vector2d p_T_mm(const Eigen::Vector2d& p_S_mm) const;

  const head_service::HeadSetup& setup_;
  calibrate::MarkJob job_;
  vision::UnitPose pose_;
  std::map<int, Eigen::Vector2d> marks_S_mm_;
  std::vector<camera::KerfTile> tiles_;
};

}  // namespace kerfbench::test
