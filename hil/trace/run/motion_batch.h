// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hil/trace/json_text.h"
#include "twin/scene/moving_scene.h"

namespace kerfbench::trace {

/// Columns of the pose that one kind of machine has.
inline constexpr std::size_t kMotionColumns = 8;

/// A row of /motion.
struct MotionRow {
  double time_s{};
  std::array<double, kMotionColumns> columns{};        ///< In the order of twin::poseColumnsOf().
  Eigen::Vector3d spot_W_mm{Eigen::Vector3d::Zero()};  ///< NaN: the beam misses the board.
  double power_w{};
  bool lit{};
};

/// Digits after the point of a column by the unit in its name.
int decimalsOf(std::string_view column);

/// A message of /motion in the making.
class MotionBatch {
 public:
  explicit MotionBatch(const std::vector<twin::PoseColumn>& columns);
  void add(const MotionRow& row);
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] double first_s() const { return first_s_; }
  /// The message; the batch is empty then.
  std::string take();

 private:
  struct Named {
    std::string name;
    int decimals{};
    JsonColumn values;
  };
  std::vector<Named> pose_;
  JsonColumn time_, spot_x_, spot_y_, spot_z_, power_, lit_;
  std::size_t rows_{};
  double first_s_{};
};

}  // namespace kerfbench::trace
