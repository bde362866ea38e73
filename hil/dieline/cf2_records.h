// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/base/progress.h"
#include "hil/dieline/faults.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// A line or an arc of a CF2 file, in the file's own unit.
struct Cf2Curve {
  Curve curve;
  int type{};        ///< What the rule does: 1 cuts, 2 creases ...
  double rule_pt{};  ///< Thickness of the rule ("pointage"), 1/72 inch.
  int bridges{};     ///< Bridges of the die board under the rule.
  int line{};        ///< In the file, counted from 1.
};

/// A copy of a SUB: scaled, then turned, then shifted.
struct Cf2Copy {
  std::string name;
  Eigen::Vector2d shift{Eigen::Vector2d::Zero()};  ///< In the file's own unit.
  double angle_deg{};                              ///< Counter-clockwise.
  Eigen::Vector2d scale{Eigen::Vector2d::Ones()};  ///< Negative values mirror.
  int line{};
};

/// What MAIN or a SUB draws.
struct Cf2Block {
  std::vector<Cf2Curve> curves;
  std::vector<Cf2Copy> copies;
  int line{};
};

/// A CF2 file (Common File Format, revision 2) as it is written, before any SUB is placed.
struct Cf2File {
  Cf2Block main;
  std::map<std::string, Cf2Block> subs;
  double unit_mm{};  ///< 1 or 25.4.
  std::size_t texts{};
  bool has_end{};  ///< The file says $EOF.
};

/// Reads all records. What is wrong is added to `faults`, with its line.
Cf2File readCf2Records(const std::string& text, FaultList& faults, base::ShareProgress& progress);

}  // namespace kerfbench::dieline
