// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/diagnose/evidence.h"

namespace kerfbench::diagnose {

/// Where on the way from the drawing to the cut a deviation arises. The deviation of a cut is the sum of all
/// three.
enum class Stage {
  kProgram,     ///< Between drawing and program: the planner.
  kController,  ///< Between program and pulses: the firmware, and what it was told of head and belt.
  kMachine,     ///< Between pulses and beam: drives, mechanics, optics.
};

/// One component of a deviation that arises in one stage, mm.
struct Row {
  Stage stage{};
  double y_mm{};
  double sigma_mm{};
  Eigen::Vector2d along{0, 0};  ///< Unit vector of the component; S and W run alike but for milliradians.
  Eigen::Vector2d p_S_mm{0, 0};
  HeadState head;
  SheetState sheet;
  Eigen::Vector2d table_mm{0, 0};
  int unit{};
  int entity{-1};
  bool of_spot{};
};

/// Rows of all readings. What is not known in one stage makes no row.
std::vector<Row> rowsOf(const Evidence& evidence);

/// What a cause of size 1 makes of a row, mm.
struct Signature {
  std::string key;
  Stage stage{};
  /// What the machine may have of it within its tolerances, standard deviation in the signature's unit; 0:
  /// none.
  double usual{};
  std::function<Eigen::Vector2d(const Row&)> displacement_mm;

  [[nodiscard]] double of(const Row& row) const {
    return row.stage == stage ? displacement_mm(row).dot(row.along) : 0.0;
  }
};

/// All that are linear in their size, in a fixed order. Displacements of more than a row's first order (a
/// turn by degrees) are no matter of these; axes_fit.h finds what is that gross.
std::vector<Signature> signaturesOf(const Evidence& evidence);

/// Displacement from a time on, W.
Signature stepAt(Stage stage, int axis, double time_s);

/// What a head does to a place of W if the controller leaves its correction out: x = L tan 2a in place of
/// (sqrt(L² + y²) + d) tan 2a (Cheng et al. 2014, eq. 1 and 2).
Eigen::Vector2d withoutPincushion_mm(const MachineFacts& machine, const Eigen::Vector2d& p_W_mm);

}  // namespace kerfbench::diagnose
