// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/vision/kerf/light_law.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// One caliper across an entity.
struct Caliper {
  double u{};                                       ///< Parameter on the entity's curve.
  double station_mm{};                              ///< Arc length from its start.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< The nominal point.
  /// Place in the camera's plane at which it was looked at.
  Eigen::Vector2d p_V_mm{Eigen::Vector2d::Zero()};
  int tile{-1};        ///< Picture of the unit in which it was looked at, counted from 0; -1 if in none.
  bool found{};        ///< A kerf (or crease) crosses the caliper.
  double offset_mm{};  ///< Kerf centre minus nominal, along the left normal; NaN if not found.
  double
      sigma_mm{};  ///< Standard uncertainty of offset_mm by noise and texture, on its own (no pose, no map).
  double steady_sigma_mm{};  ///< The part of sigma_mm that neighbours have in common, over long stretches.
  double width_mm{};         ///< Width where half of the middle's light comes through; NaN if not found.
  double width_sigma_mm{};
  double brightness{};  ///< Peak of the profile, 0 board … 1 open kerf.
  bool near_joint{};    ///< True within reach of a corner, crossing or neighbour, where the profile is not a
                        ///< single kerf's.
};

/// Light at a place along a perforation.
struct LightReading {
  double station_mm{};
  double brightness{};  ///< As Caliper::brightness.
  bool near_joint{};    ///< As Caliper::near_joint: light of other kerfs may be in it.
};

struct EntityKerf {
  int unit{};
  int entity{};                   ///< Entity id.
  std::vector<Caliper> calipers;  ///< Calipers in order of station.
  /// Light along the entity if it is a perforation, more densely than by the calipers; in order of station.
  std::vector<LightReading> light{};
  double widening_mm{};  ///< Widening of the kerf by blur, over Caliper::width_mm.
  /// Standard uncertainty of the widening, common to all kerfs of the picture: by that of its blur,
  /// and by walls.
  double widening_sigma_mm{};
  /// The part of it by walls that are seen aslant. How much of its walls a slit hides is the same share for
  /// all, but of more where the sight is more aslant: kerfs differ by it as they differ in this.
  double walls_sigma_mm{};
  /// Standard deviation of the light that Caliper::brightness mixes, across the kerf: lens, pixel, and the
  /// pixels that count as its middle.
  double middle_sigma_mm{};
  /// Depth below the printed face at which the camera sees the kerf's middle, and its standard uncertainty;
  /// see sightDepths(). Offsets are those of that depth.
  double depth_mm{};
  double depth_sigma_mm{};
  /// How deep it may be; as SightDepth::deepest_mm().
  [[nodiscard]] double deepest_mm() const { return depth_mm + depth_sigma_mm; }
};

/// Corner as cut, where two entities of one unit meet or one turns.
struct CornerKerf {
  int unit{};
  int entity_in{}, entity_out{};                    ///< Entity ids; the same for a corner within one.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Nominal.
  double turn_rad{};  ///< Angle from the tangent in to the tangent out, (-pi, pi].
  bool found{};
  /// A leg is so short that no caliper lies on it undisturbed by the joints at its ends, so the corner cannot
  /// be measured, however well it was cut. Follows from the drawing alone.
  bool short_leg{};
  /// Rounding of the corner, relative to where its own legs as cut would meet: a cut that is displaced as a
  /// whole has neither.
  double rounding_mm{};   ///< Distance of the kerf's centre line inside of that place; >= 0.
  double overshoot_mm{};  ///< Overrun of the farther leg beyond that point, along the leg; >= 0.
  /// Deviation of the corner: the farthest that the kerf's centre line lies from the nominal dieline within
  /// KerfScanOptions::joint_clearance_mm of the corner, or the nominal corner from the centre line (Hausdorff
  /// distance); >= 0. A displaced cut has it.
  double deviation_mm{};
  /// Standard uncertainties, without pose and map.
  double rounding_sigma_mm{}, overshoot_sigma_mm{}, deviation_sigma_mm{};
};

/// Free begin or end of an open entity.
struct LineEnd {
  int unit{};
  int entity{};
  bool at_start{};
  bool found{};
  double
      gap_mm{};  ///< Nominal end minus end of the kerf's centre line, along it: > 0 too short, < 0 too long.
  double sigma_mm{};
};

/// Pose of a unit on the table, by its printed marks: p_T = R(angle) p_S + p_TS.
struct UnitPose {
  int unit{};
  Eigen::Vector2d p_TS_mm{Eigen::Vector2d::Zero()};
  double angle_rad{};
  /// Covariance of p_TS x, p_TS y and angle by the noise of the marks: mm², mm rad, rad².
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  double residual_mm{};  ///< RMS of the marks; NaN with fewer than two.
  int marks{};
  /// Mean place of the unit's marks as printed, in S: an error of scale leaves it where it is.
  Eigen::Vector2d marks_centre_S_mm{Eigen::Vector2d::Zero()};
};

/// Something burnt where the dieline has nothing.
struct StrayCut {
  int unit{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Centre of the blob.
  double extent_mm{};                               ///< Longest side of its box.
};

/// A small picture around the worst place of an entity, for the report.
struct KerfPatch {
  int unit{};
  int entity{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  std::shared_ptr<const GrayImage> image;  ///< Never null.
  Eigen::Affine2d pixel_from_S{
      Eigen::Affine2d::Identity()};  ///< Local map, to draw the dieline into the patch.
};

/// All that the camera saw of one unit as one picture, for the report.
struct KerfMosaic {
  int unit{-1};
  std::shared_ptr<const GrayImage> image;  ///< Null: none. Its rows run down from the largest y.
  Eigen::AlignedBox2d box_S_mm;            ///< What it shows.
};

struct KerfScanOptions {
  double station_pitch_mm{0.25};
  double reach_mm{0.6};  ///< Half length of a caliper.
  double joint_clearance_mm{0.4};
  double stray_min_mm{0.5};  ///< Smaller blobs are not told; see inspect::Tolerances::leastStray_mm().
  int patches{6};            ///< Number of worst places to keep pictures of.
  int mosaic_px{0};          ///< Longest side of KerfScan::mosaic; 0: none is made.
  /// 1/e² radius of the beam, from the set-up of the laser: how far a kerf's outline reaches beyond where the
  /// beam stopped or turned follows from it and from the kerf's width. 0: as far as a round tool as wide as
  /// the kerf.
  double beam_radius_mm{0.0};
  /// Relative standard uncertainty of beam_radius_mm: an end is as uncertain as that share of the radius.
  double beam_radius_sigma{0.05};
  /// How light grows with the burn, as the board's data sheet has it, and the standard uncertainties of that.
  /// Flanks of kerfs that are cut through tell it better.
  LightGrowth growth{};
  /// LightGrowth::begin lies in 0 … 0.9 (upright walls), and twice its uncertainty takes in all of that.
  double law_sigma{0.8}, begin_sigma{0.45};
  /// Back light through an open kerf, as the light was set up: brightness 1.
  double open_gray{235.0};
  double open_gray_sigma{0.02};  ///< Relative standard uncertainty of it.
  double widest_blur_px{
      1.5};  ///< Standard deviation beyond which the edges of marks show a picture as blurred.
  /// Thickness of the board by its data sheet; 0: too thin to matter, and kerfs are taken to lie in the plane
  /// of the marks.
  double board_thickness_mm{0.0};
  /// Standard uncertainty of where the inspection table says that a tile was taken, per axis.
  double table_sigma_mm{0.0};
  /// Relative standard uncertainty of the table's scale.
  double table_scale_sigma{0.0};
  /// Relative standard uncertainty of what else makes all of a sheet seem too large or too small: the scale
  /// of the calibration's target, and how much the board has swelled since it was cut.
  double scale_sigma{0.0};
  /// Standard uncertainty of where a registration mark is printed, per axis.
  double print_sigma_mm{0.0};
  int threads{1};  ///< The result is the same at any number.
};

struct KerfScan {
  std::vector<EntityKerf> entities;  ///< Kerfs of all units and all entities that are not kIgnore.
  std::vector<CornerKerf> corners;
  std::vector<LineEnd> ends;
  std::vector<UnitPose> units;  ///< Poses of the units whose marks were found.
  std::vector<StrayCut> strays;
  std::vector<KerfPatch> patches;  ///< Patches, the worst first.
  KerfMosaic mosaic;               ///< The worst unit.
  double mark_residual_mm{};       ///< Worst RMS over units of marks against their places.
  /// RMS per axis of how far the same kerf lies apart in two overlapping tiles, what the board's thickness
  /// explains taken out; NaN without overlaps.
  double tile_misfit_mm{};
  /// As KerfScanOptions::table_sigma_mm; 0 where one tile shows each unit: the table does not matter then.
  double table_sigma_mm{};
  /// Relative standard uncertainty of all scales together: KerfScanOptions::scale_sigma, and that of the
  /// table where it matters.
  double scale_sigma{};
  /// Reasons not to trust the scan (marks not found, tile missing): INVALID.
  std::vector<std::string> problems;
};

}  // namespace kerfbench::vision
