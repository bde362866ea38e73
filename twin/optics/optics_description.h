// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

namespace kerfbench::twin {

/// Deviation of a mirror from the drawing (see ScanHead for the drawing and its frame H). All zero: as drawn.
struct MirrorAlignment {
  /// Turn of the axis about its place by the rotation vector with these two components normal to it: along Hx
  /// and Hy for the first mirror, along Hy and Hz for the last. The mirror's normal at angle zero stays as
  /// drawn: the mirrors of a head are glued in so that the beam at rest is centred. |.| <= 0.1.
  std::array<double, 2> axis_tilt_rad{};
  /// Distance of the reflecting surface before (+) its axis, along its normal. |.| <= 50.
  double surface_offset_mm{};
  double zero_rad{};  ///< Mechanical angle at command zero. |.| <= 0.5.
  double scale{1.0};  ///< Angle of the mirror over the angle of the motor's encoder; 0.5 … 2.
};

/// An f-theta lens after the mirrors, drawn with its principal point at height f over W's origin, looking
/// down. In its focal plane a beam at field angle t from the axis arrives at radius f t (1 + k1 t² + k2 t⁴)
/// from the centre, wherever it passed through the lens.
struct LensDescription {
  /// Largest field angle; beams beyond it are lost. No lens takes more.
  static constexpr double kMaxFieldAngle_rad = 0.7;

  double focal_length_mm{};  ///< Focal length f; in (0, 1e5].
  /// Deviation from f theta, 1/rad² and 1/rad⁴. |.| <= 10, and the radius must grow with the field angle up
  /// to kMaxFieldAngle_rad.
  double k1{}, k2{};
  /// Offset of the principal point from the drawing, along Wx, Wy; |.| <= 50.
  std::array<double, 2> decentre_mm{};
  /// Rotation vector along Wx, Wy by which the lens and its focal plane are turned about the principal point.
  /// |.| <= 0.1.
  std::array<double, 2> tilt_rad{};
  /// Chief ray's angle to the axis at the sheet over the field angle: 0 telecentric, 1 as without a lens.
  double incidence_ratio{1.0};  ///< -0.5 … 1.5.
};

/// The beam between tube and sheet.
struct BeamDescription {
  double waist_radius_mm{0.105};  ///< 1/e² radius in focus at normal incidence; in (0, 100].
  /// Distance from the waist at which the radius has grown by sqrt 2; > 0. Infinity: no caustic.
  double rayleigh_mm{20.0};
  /// Height of the waist over the work plane, on the optical axis; |.| <= 1e4. Elsewhere it lies
  ///   without a lens after the mirrors: at the same length of path from the tube, hence higher;
  ///   with an f-theta lens: in the plane this far before the lens's focal plane;
  ///   of a gantry: at this height.
  double focus_z_mm{};
  /// Offset of the entering beam. Scan head: along Hy and Hz, where it passes the first mirror's axis.
  /// Gantry: along Wx and Wy, on the work plane. |.| <= 50.
  std::array<double, 2> offset_mm{};
  /// Rotation vector of the entering beam about that point: along Hy and Hz, or Wx and Wy. |.| <= 0.1.
  std::array<double, 2> tilt_rad{};
};

/// A two-mirror head, see ScanHead for the drawing.
struct ScanHeadDescription {
  /// Throw L: last mirror to work plane; in (0, 1e5]. With a lens f decides, and L only gives the place of
  /// the mirrors.
  double throw_mm{500.0};
  double mirror_spacing_mm{15.0};  ///< Distance d between the mirrors' axes; 0 … 1e4.
  bool y_mirror_first{};  ///< True if the Y mirror meets the beam first; the drawing is turned accordingly.
  MirrorAlignment x{}, y{};
  std::optional<LensDescription> lens{};
};

/// Surface of the board while the beam meets it: height over the work plane
///
///     z = height + slope · p + ½ curvature · p² + flutter sin(2 pi (f t - x / wavelength) + phase)
struct SurfaceDescription {
  double height_mm{};                      ///< Height; |.| <= 1000.
  std::array<double, 2> slope{};           ///< Slopes dz/dx and dz/dy; |.| <= 0.1.
  std::array<double, 2> curvature_1_mm{};  ///< Curl along x and across; |.| <= 0.01.
  double flutter_mm{};                     ///< Amplitude; 0 … 50, and no steeper than 0.5 anywhere.
  double flutter_hz{};                     ///< Frequency; 0 … 1e5.
  double flutter_wavelength_mm{500.0};     ///< Wavelength along x; > 0. Infinity: all of the board at once.
  double flutter_phase_rad{};              ///< Phase; |.| <= 1e3.
};

/// Everything that is wrong with a description in one line, "head.throw_mm must be in (0, 1e5], is -1; …";
/// empty if nothing is. NaN is always wrong, infinity wherever it is not allowed above.
std::string faultsOf(const ScanHeadDescription& head);
std::string faultsOf(const BeamDescription& beam);
std::string faultsOf(const SurfaceDescription& surface);

}  // namespace kerfbench::twin
