// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "twin/base/print_layout.h"

namespace kerfbench::diagnose {

/// The head at the begin of a span of kSpan_s within one opening of the laser's gate, by the pins alone.
struct AskedInstant {
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};  ///< Where the pulses lead.
  double sheet_x_mm{};                              ///< x_W of unit 0's origin, by the encoder.
  double light_share{};                             ///< Share of the span in which the laser shines.
};

/// One opening of the gate, an instant each kSpan_s. Speeds of firmware change in steps: Grbl's each 10 ms.
using AskedCut = std::vector<AskedInstant>;
inline constexpr double kSpan_s = 5e-3;

/// A laser that shines as long where the beam is slow as where it is fast.
struct SteadyPower {
  double slow_share{};   ///< Median speed of the slow spans, as a share of the fast ones'.
  double light_share{};  ///< Light in those, as a share of that in the fast ones.
};

/// Compares the light of the spans in which the beam moves over the sheet at a tenth to half of its usual
/// speed with those at full speed. Nullopt if it is less by 15 % or more, or if fewer than five spans are
/// slow or fast.
std::optional<SteadyPower> steadyPower(const std::vector<AskedCut>& cuts);
/// "The laser keeps its power where the beam is slow: …"
std::string sentenceOf(const SteadyPower& power);

/// What the pulses ask for.
struct AskedMotion {
  double off_mm{};  ///< Largest distance of where they lead from the drawing.
  /// Largest acceleration of each axis of W over two spans.
  Eigen::Vector2d acceleration_mm_s2{Eigen::Vector2d::Zero()};
};

/// Nullopt without a cut of three instants.
std::optional<AskedMotion> askedMotion(const std::vector<AskedCut>& cuts, const dieline::Dieline& dieline,
                                       const PrintLayout& print);

}  // namespace kerfbench::diagnose
