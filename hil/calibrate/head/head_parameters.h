// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include <Eigen/Core>

#include "hil/calibrate/head/nominal_head.h"

namespace kerfbench::calibrate {

/// Departures of a head as built from its design; all zero: as drawn. mm, rad, or a share of the design's
/// value. HeadModel says where each acts.
enum class HeadParameter : std::size_t {
  kThrow,          ///< mm
  kMirrorSpacing,  ///< mm
  kXAxisTiltA,     ///< rad; of the X mirror's axis, across its normal at rest,
  kXAxisTiltB,     ///< rad; and towards it.
  kXFaceTilt,      ///< rad; of the reflecting face towards the axis.
  kXSurface,       ///< mm; of the face before the axis.
  kXZero,          ///< rad; mechanical angle at command zero.
  kXScale,         ///< Share by which it turns further than commanded.
  kYAxisTiltA,
  kYAxisTiltB,
  kYFaceTilt,
  kYSurface,
  kYZero,
  kYScale,
  kBeamOffsetA,    ///< mm; of the beam as it enters, horizontally,
  kBeamOffsetB,    ///< mm; and upwards.
  kBeamTiltA,      ///< rad; horizontally,
  kBeamTiltB,      ///< rad; and upwards.
  kPlaneHeight,    ///< mm; of the sheet over the work plane at W's origin.
  kPlaneSlopeX,    ///< dz/dx
  kPlaneSlopeY,    ///< dz/dy
  kPlaneShiftX,    ///< mm; of the head's frame in that of the measurement.
  kPlaneShiftY,    ///< mm
  kPlaneTurn,      ///< rad; likewise, from x to y.
  kFocalLength,    ///< Share.
  kLensK1,         ///< 1/rad²
  kLensK2,         ///< 1/rad⁴
  kLensDecentreX,  ///< mm; of the principal point.
  kLensDecentreY,  ///< mm
  kLensTiltX,      ///< Tilt of the lens's axis: its run along x and y for each mm downwards.
  kLensTiltY,
  kLensIncidence,  ///< The lens's incidence_ratio.
};
inline constexpr std::size_t kHeadParameterCount = 32;
/// Number of parameters as an index of matrices.
inline constexpr int kHeadColumns = static_cast<int>(kHeadParameterCount);

constexpr std::size_t indexOf(HeadParameter parameter) { return static_cast<std::size_t>(parameter); }

using HeadVector = Eigen::Matrix<double, static_cast<int>(kHeadParameterCount), 1>;

struct HeadParameterText {
  std::string_view name;  ///< "tilt of the X mirror's axis across its normal"
  std::string_view unit;  ///< "mm", "rad", "" of a share, "1/rad²", "1/rad⁴".
};
HeadParameterText textOf(HeadParameter parameter);

/// False for a parameter that moves no spot of such a head: of the lens, where there is none; what only
/// shifts the beam sideways, where a lens follows.
bool actsOn(HeadParameter parameter, const HeadDesign& design);

/// Standard deviations of the parameters before anything is measured: what a mechanic can be trusted with.
/// They keep what the marks cannot tell near the drawing; they must not be smaller than what may happen.
struct HeadTolerances {
  double throw_share{0.01};
  double mirror_spacing_mm{1.0};
  double axis_tilt_rad{5e-3};
  double face_tilt_rad{5e-3};
  double surface_mm{0.5};
  double zero_rad{5e-3};
  double scale_share{5e-3};
  double beam_offset_mm{1.0};
  double beam_tilt_rad{5e-3};
  double plane_height_mm{2.0};
  double plane_slope{5e-3};
  double plane_shift_mm{2.0};
  double plane_turn_rad{5e-3};
  double focal_length_share{0.01};
  double lens_k1_1_rad2{0.05};
  double lens_k2_1_rad4{0.05};
  double lens_decentre_mm{1.0};
  double lens_tilt{5e-3};
  double lens_incidence{0.3};
  /// Error of encoders, lens and board beyond all parameters, as a share of the field's longer side: 30 µm of
  /// 300 mm. No parameter; it weighs the residual surface where marks are too few to tell it.
  double unmodelled_share{1e-4};

  /// Departures in HeadParameter's order and units.
  [[nodiscard]] HeadVector sigmas(const HeadDesign& design) const;
};

}  // namespace kerfbench::calibrate
