// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "hil/gauge/artefact.h"
#include "hil/gauge/beam.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::gauge {

/// Truth of a cut, by the geometry of the path and the optics of the beam alone; no camera has a part in it.
/// In mm and in S, the frame of the printed marks, which are where the print says.
///
/// The deviation of a line at a station is that of its kerf's middle along the nominal left normal. The
/// middle is that of the light which falls there, from before and behind: the path's offset, averaged with
/// the Gaussian of the beam along it. In a bend of curvature kappa that lies kappa s²/2 inside of the path, s
/// being the standard deviation of the light; at an end, where light comes from one side alone, it lags
/// behind a path that runs aslant. Stations are those that inspection judges lines at: all within the length
/// of the line as it was cut, farther than 0.4 mm from a corner.
///
/// Worst, RMS and circularity are of these deviations; circularity is the range about the least-squares
/// circle. Width is the mean over the same stations of the distance between the two places across the kerf
/// where half of the light comes through that does in its middle, over the board's. Rounding and overshoot
/// say how far the beam's path passes inside of where its own legs would meet, or its legs run on beyond it;
/// a gap how much too early a line ends.
struct EntityTruth {
  int entity{};
  double worst_mm{};  ///< Magnitude.
  double rms_mm{};
  double width_mm{};
  double circularity_mm{};          ///< NaN but for the circle.
  std::vector<double> offset_mm{};  ///< Offset of each caliper of EntityKerf, judged or not.
};
struct CutTruth {
  std::vector<EntityTruth> entities;  ///< Entities in the order of the scan's.
  double worst_mm{};                  ///< Worst deviation of all lines.
  double rms_mm{};
  double rounding_mm{},
      overshoot_mm{};  ///< Rounding and overshoot of the corner, against where its legs as cut would meet.
  double corner_mm{};  ///< Distance of its path and the nominal one (Hausdorff).
  double corner_shift_mm{};  ///< Shift of the corner by faults of other kinds.
  struct End {
    int entity{};
    bool at_start{};
    double gap_mm{};  ///< < 0: too long.
  };
  std::vector<End> ends;
  [[nodiscard]] double worstJoint_mm() const;  ///< Worst of the corner's deviation and the ends.
};

/// An artefact with faults as a path of the beam. Everything is exact to 0.02 µm for features longer than
/// 0.3 mm.
class ArtefactCut {
 public:
  /// `artefact` must outlive this. `noise_seed`: of the tube's noise.
  ArtefactCut(const Artefact& artefact, std::vector<Fault> faults, const ArtefactBeam& beam,
              std::uint64_t noise_seed);

  /// Burns with 1.6 times what cuts through in the middle of a line at the beam's nominal radius, for a
  /// crease what burns 0.8 of the thickness, at 300 mm/s, entity by entity.
  void burn(twin::Sheet& sheet, double nominal_radius_mm) const;
  [[nodiscard]] CutTruth truth(const std::vector<vision::EntityKerf>& stations,
                               const twin::BoardDescription& board, double nominal_radius_mm) const;
  /// The worst deviation of lines, corner and ends without a scan, at stations of this pitch.
  [[nodiscard]] double worst_mm(double pitch_mm) const;

 private:
  struct Line {
    const dieline::Entity* entity{};
    double length_mm{};
    double start_gap_mm{}, end_gap_mm{};  ///< Length by which each end is cut too short.
    double start_s{};                     ///< Time at which the beam is at its nominal start.
    std::vector<double> power{};          ///< Relative, of each step of the burn.
  };

  [[nodiscard]] Eigen::Vector2d pathAt(const Line& line, double s_mm) const;
  [[nodiscard]] Eigen::Vector2d shiftAt(const Line& line, double s_mm) const;
  [[nodiscard]] double offsetAt(const Line& line, double s_mm) const;
  [[nodiscard]] double widthAt(const Line& line, double s_mm, double fluence_share,
                               const twin::BoardDescription& board) const;
  [[nodiscard]] bool judged(const Line& line, double s_mm) const;
  [[nodiscard]] double relativePower(const Line& line, double s_mm) const;
  [[nodiscard]] double gapOf(const Line& line, bool at_start) const;
  void joints(CutTruth& truth) const;
  void corner(CutTruth& truth) const;
  /// The arc that a corner is cut by.
  struct Cut {
    Eigen::Vector2d tangent_in, side;
    double turn_rad{}, radius_mm{};
  };
  [[nodiscard]] Cut cutOfCorner() const;
  /// Distance before the nominal corner at which the legs end; < 0: beyond it.
  [[nodiscard]] double beforeCorner() const;
  /// How far the arc lies inside of a leg at a place of it; nothing before the arc begins.
  [[nodiscard]] Eigen::Vector2d arcShift(const Line& line, double s_mm) const;
  /// Continues from the end of a path by the arc, if there is one.
  void addArc(std::vector<Eigen::Vector2d>& way) const;
  void burnWay(twin::Sheet& sheet, const std::vector<Eigen::Vector2d>& way, const Line& line,
               double from_s_mm, double energy_j_mm) const;

  const Artefact& artefact_;
  std::vector<Fault> faults_;
  ArtefactBeam beam_;
  Eigen::Vector2d middle_mm_;
  double reach_mm_{};  ///< Distance from the middle to the farthest cut.
  double corner_mm_{};
  std::vector<Line> lines_;
};

}  // namespace kerfbench::gauge
