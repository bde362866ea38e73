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
#include "hil/camera/tile_source.h"
#include "hil/head_service/head_setup.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::test {

/// The pictures of a sheet of field marks as `calibrate head --keep-pictures` wrote them, to be spoiled and
/// written elsewhere. What is done to a mark is done in every picture that shows it.
class SpoiledSheet {
 public:
  /// @param sheet with marks.yaml and pictures/.
  SpoiledSheet(const std::filesystem::path& sheet, const head_service::HeadSetup& setup);

  [[nodiscard]] std::size_t size() const { return tiles_.size(); }
  [[nodiscard]] std::vector<int> numbers() const;
  /// As if it had never been cut: board from beside it.
  void erase(int number);
  /// Cut once more, there.
  void again(int number, const Eigen::Vector2d& by_mm);
  /// Cut there instead.
  void move(int number, const Eigen::Vector2d& by_mm);
  /// A board on which nothing is printed.
  void erasePrint();
  /// Any picture, from 0.
  void change(std::size_t tile, const std::function<void(cv::Mat&)>& how);
  void changeAll(const std::function<void(cv::Mat&)>& how);
  /// Where the camera is said to have stood.
  void shift(std::size_t tile, const Eigen::Vector2d& by_mm) { tiles_.at(tile).p_TV_mm += by_mm; }

  /// All pictures and tiles.yaml.
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
