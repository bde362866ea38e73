// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace kerfbench::inspect {

/// Longest time from an open guard, or from whatever else must stop a run, to a dark laser.
inline constexpr double kLaserOff_s = 100e-6;

/// Default of the age up to which a camera's calibration counts.
inline constexpr int kCalibrationMaxAge_days = 180;

/// Smaller burnt places are dust, unless the limit of strays is smaller.
inline constexpr double kDust_mm = 0.5;

/// Defaults of orders.
inline constexpr double kPerforationLimit_mm = 0.15;
inline constexpr double kOrderedWidthLimit_mm = 0.03;

/// What a cut may be off, and which checks a scenario asks for.
struct Tolerances {
  /// What must lie on the dieline: the kerf's centre, or the edge of the wanted piece, with the kerf outside
  /// of closed cuts, inside of them, or outside of outlines and inside of holes (closed cuts within an odd
  /// number of others). Open cuts have no such edge (see OpenCuts); other processes are judged by their
  /// centre.
  enum class Edge { kCentre, kOutside, kInside, kNesting };
  Edge edge{Edge::kCentre};
  /// With an edge: where the kerf lies along open cuts, seen along the one of the smallest number of those
  /// that meet end to end, in its own sense. Left of it the kerf's right edge must lie on the dieline.
  enum class OpenCuts { kCentre, kLeft, kRight };
  OpenCuts open_cuts{OpenCuts::kCentre};

  /// A perforation as ordered. Between two corners (0.05 rad) or ends, whatever entities it is drawn of, a
  /// whole number of cuts is laid, the first and the last at the corners: cut and bridge are stretched by one
  /// factor, as little as it takes. A closed line without a corner may begin anywhere. Lengths are those of
  /// the holes.
  struct Perforation {
    double cut_mm{3.0};  ///< 0: nothing is ordered.
    double bridge_mm{1.0};
    double limit_mm{kPerforationLimit_mm};  ///< Departure of a length, or of the place of an end.
  };
  /// Width of cuts where half of the middle's light comes through; 0: nothing is ordered.
  struct OrderedWidth {
    double nominal_mm{0.0};
    double limit_mm{kOrderedWidthLimit_mm};
  };
  /// Depth over the board's thickness, from the least to the most that is allowed; most 0: nothing is
  /// ordered.
  struct OrderedDepth {
    double least{0.0};
    double most{0.0};
  };

  double path_mm{0.05};  ///< Deviation of lines, corners and ends from the dieline.
  double stillness_mm{0.05};
  double uncut_mm{0.15};        ///< Longest piece of a line, away from its ends, that is not burnt.
  double uncut_share{0.005};    ///< Largest share of a cut that many uncut pieces may make up together.
  double cut_through_mm{0.15};  ///< Longest piece of a crease or half-cut that is cut through.
  double kerf_width_mm{0.05};   ///< Largest change of an entity's width from the width usual for its process.
  double stray_mm{0.5};         ///< Longest stray cut allowed.
  double end_gap_mm{0.15};      ///< Longest piece left uncut at the start or the end of an entity.
  double passes{1.5};           ///< An entity along which the spot went more often than this was cut twice.
  double gate_tail_s{0.002};    ///< Longest time the spot may be seen outside the laser gate.
  double dwell_mm{1.0};         ///< Light on one place, as that of so long a cut; see dwellCheck().
  double gate_lag_s{
      0.0005};  ///< Between the laser's gate and the instant at which the beam sets off, either way.
  Perforation perforation{};
  OrderedWidth ordered_width{};
  OrderedDepth crease_depth{};
  OrderedDepth half_cut_depth{};
  double even_depth_share{0};        ///< Largest change of depth along creases and half-cuts; 0: not judged.
  int depth_points{0};               ///< Points of even_depth besides its stretches; 0: none.
  double board_thickness_mm{0.4};    ///< Thickness of whole board, for depths in mm.
  double board_transmission{0.12};   ///< Light through whole board, by which depth is told.
  double line_energy_j_mm{0};        ///< Laser energy per length that marks were to get; 0: not judged.
  double line_energy_share{0.0147};  ///< Largest departure from it (Wang, Li, Chen 2010).

  /// Extent of the smallest stray cut that a scan must tell, in pictures of that pitch: anything from half a
  /// millimetre on is no dust, and what is up to two pixels smaller than the limit is not proven to keep it.
  [[nodiscard]] double leastStray_mm(double pitch_mm) const {
    return std::max(0.0, std::min(kDust_mm, stray_mm) - 2.0 * pitch_mm);
  }
};

}  // namespace kerfbench::inspect
