// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/nominal_head.h"
#include "twin/optics/scan_head.h"
#include "twin/optics/surface.h"

namespace kerfbench::calibrate::test {

enum class HeadKind { kTwoMirror100, kTwoMirror300, kTwoMirror800, kFTheta300 };
std::string nameOf(HeadKind kind);

/// Errors of a hidden head that no parameter of HeadModel describes.
enum class Beyond {
  kNothing,
  kBentBoard,  ///< The sheet is a shallow dish, 30 µm (1 sigma) at the middle of each side.
  /// Bent board, with errors of the mirrors' encoders: a cubic (100 µrad at the rim) and a wave (5 µrad).
  kAnalogue,
};

/// A head with hidden, seeded misalignment and lens: the twin's ray trace, with which the fit shares nothing.
/// Departures are normal, 0.6 of HeadTolerances' defaults.
class SimulatedHead {
 public:
  SimulatedHead(HeadKind kind, Beyond beyond, std::uint64_t seed);

  /// Data that a service engineer has.
  [[nodiscard]] const NominalHead& nominal() const { return nominal_; }
  [[nodiscard]] const HeadDesign& design() const { return design_; }
  [[nodiscard]] const Eigen::AlignedBox2d& field_W_mm() const { return field_W_mm_; }
  /// HeadTolerances::unmodelled_share by the data sheets of encoders and board: the spread from which this
  /// head is sampled.
  [[nodiscard]] double unmodelledShare() const { return unmodelled_share_; }

  /// Place where the beam really lands; `rounded`: with the mirrors at whole steps.
  /// @throws std::runtime_error where it lands nowhere.
  [[nodiscard]] Eigen::Vector2d spotFor(const Eigen::Vector2d& aim_W_mm, bool rounded) const;
  /// Change of the drives: mirrors' zeros and gains, the head's turn, the sheet's height.
  struct Change {
    Eigen::Vector2d zero_rad{Eigen::Vector2d::Zero()};
    Eigen::Vector2d gain{Eigen::Vector2d::Ones()};
    double turn_rad{};
    double height_mm{};
  };
  void change(const Change& change);

 private:
  NominalHead nominal_;
  HeadDesign design_;
  Eigen::AlignedBox2d field_W_mm_;
  twin::ScanHeadDescription head_;
  twin::BeamDescription beam_;
  twin::SurfaceDescription surface_;
  Eigen::Vector2d cubic_rad_{Eigen::Vector2d::Zero()}, wave_rad_{Eigen::Vector2d::Zero()};
  Eigen::Vector2d wave_phase_{Eigen::Vector2d::Zero()};
  double most_angle_rad_{};
  double unmodelled_share_{1e-6};
  Change change_;
  std::vector<twin::ScanHead> truth_;  // One head; a vector, since a head cannot be assigned.
  std::vector<twin::Surface> board_;
};

}  // namespace kerfbench::calibrate::test
