// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "twin/optics/beam_caustic.h"
#include "twin/optics/optics_description.h"
#include "twin/optics/surface.h"

namespace kerfbench::twin {

/// Two mirrors above a board, by ray trace.
///
/// The drawing, in the head's frame H (origin on the work plane under the resting beam, Hz up): the first
/// mirror's axis passes (0, -d, L) along -Hz; its normal at rest is (-1, 1, 0)/sqrt 2 and the laser beam
/// reaches it along +Hx. The last mirror's axis passes (0, 0, L) along +Hx; its normal at rest is
/// (0, -1, -1)/sqrt 2. Both reflecting surfaces hold their axis. The first mirror is plane and endless, so is
/// the last; neither reflects at its back or where the beam meets it flatter than kFlattest.
///
///   X mirror first: H is W. With mirror angles a, b and a board at z = 0 the drawing gives
///
///       y = L tan 2b,   x = (sqrt(L² + y²) + d) tan 2a          (Cheng et al. 2014, eq. 1)
///
///   Y mirror first: the drawing is turned by -90 degrees about Wz, so that Hx = -Wy and Hy = +Wx: the beam
///   enters along -Wy, the Y mirror is at (-d, 0, L), the X mirror at (0, 0, L). The Y mirror's axis is +Wz,
///   against the drawing's, so that a positive angle of either mirror still moves the spot along its own
///   positive axis: x = L tan 2a, y = (sqrt(L² + x²) + d) tan 2b.
///
/// Both formulas are results here and no input: nothing of them is shared with the controller's inverse.
/// Immutable, so safe to share between threads.
class ScanHead {
 public:
  /// Cosine of the flattest incidence on a mirror and on the board that still counts: 84 degrees.
  static constexpr double kFlattest = 0.1;
  /// Largest distance, mm, by which the last mirror may meet the beam before the first: with a spacing near
  /// zero the mirrors of the formula stand inside each other.
  static constexpr double kOverlap_mm = 10.0;

  /// Makes a head. @throws std::invalid_argument with all of faultsOf(head) and faultsOf(beam).
  ScanHead(const ScanHeadDescription& head, const BeamDescription& beam);

  /// Point of each mirror's axis, about which it is misaligned, and the axis as misaligned, in W. A mirror
  /// turns by a positive angle about its axis, right-handed.
  [[nodiscard]] const Eigen::Vector3d& xMirrorPlace_mm() const { return xMirror().place_mm; }
  [[nodiscard]] const Eigen::Vector3d& yMirrorPlace_mm() const { return yMirror().place_mm; }
  [[nodiscard]] const Eigen::Vector3d& xMirrorAxis() const { return xMirror().axis; }
  [[nodiscard]] const Eigen::Vector3d& yMirrorAxis() const { return yMirror().axis; }

  /// Spot on the board. `mirror_rad`: angles of the X and Y motor's encoders; each mirror's zero and scale
  /// are applied here. `head_shift_mm`: displacement of frame, tube and head along Wx and Wy. nullopt if a
  /// mirror does not receive the beam or does not send it to the board: turned too far, out of the lens's
  /// field, too flat, no intersection with the surface; or an argument that is not finite.
  [[nodiscard]] std::optional<BeamSpot> spotAt(const Eigen::Vector2d& mirror_rad,
                                               const Eigen::Vector2d& head_shift_mm, const Surface& surface,
                                               double time_s) const;

 private:
  struct Mirror {
    Eigen::Vector3d place_mm;
    Eigen::Vector3d axis;
    Eigen::Vector3d along;    ///< Component along the axis of the normal at rest.
    Eigen::Vector3d across;   ///< Component across the axis of the normal at rest.
    Eigen::Vector3d quarter;  ///< Component `across` after a quarter turn.
    MirrorAlignment alignment;
    Eigen::Index motor{};  ///< Index of the motor: 0 X, 1 Y.
  };
  struct Lens {
    LensDescription description;
    Eigen::Vector3d centre_mm;  ///< Centre of the focal plane.
    Eigen::Vector3d axis;       ///< Direction of the axis, downwards.
    double most_sine{};         ///< Largest sine of the field angle.
  };
  /// A straight ray with its place along the path: `path_mm` from the tube's side to p_W_mm.
  struct Ray {
    Eigen::Vector3d p_W_mm;
    Eigen::Vector3d direction;
    double path_mm{};
  };

  [[nodiscard]] const Mirror& xMirror() const { return mirrors_[y_first_ ? 1 : 0]; }
  [[nodiscard]] const Mirror& yMirror() const { return mirrors_[y_first_ ? 0 : 1]; }
  static bool reflect(Ray& ray, const Mirror& mirror, double motor_rad, double least_mm);
  [[nodiscard]] std::optional<ChiefRay> throughLens(const Eigen::Vector3d& direction) const;

  bool y_first_;
  std::array<Mirror, 2> mirrors_;  ///< Mirrors in the order in which the beam meets them.
  Ray laser_;  ///< Laser beam near the first mirror's axis; its path is counted from there.
  std::optional<Lens> lens_;
  double focus_z_mm_;
  double waist_path_mm_;
  BeamCaustic caustic_;
};

/// Spot of a beam straight down from a gantry at p_W, with the offset and tilt in `beam`. nullopt as for
/// ScanHead.
std::optional<BeamSpot> gantrySpot(const Eigen::Vector2d& p_W_mm, const BeamDescription& beam,
                                   const Surface& surface, double time_s);

}  // namespace kerfbench::twin
