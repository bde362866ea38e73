// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/diagnose/power_swing.h"

namespace kerfbench::diagnose {

// What a diagnosis may know of a run: pictures, pins, the controller's words, the program that it was sent,
// the drawing and data sheets. Nothing of the model. Lengths in mm, times in s from the begin of the
// recording; frames W and S as in docs/frames.md. NaN: not known.

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The machine as its data sheet has it.
struct MachineFacts {
  bool gantry{};
  double throw_mm{};              ///< Last mirror to the work plane; 0 of a gantry.
  double spacing_mm{};            ///< First mirror to second; 0 of a gantry.
  Eigen::Vector2d step_mm{0, 0};  ///< Way of the beam for one pulse of each axis, in the middle of the field.
  double mirror_step_urad{};      ///< Mechanical angle of one pulse; 0 of a gantry.
  double tracking_delay_s{};      ///< Delay of the axes behind their pulses, as the controller was told it.
  double encoder_count_mm{};      ///< Travel of the belt for one count, by the data sheet of the machine.
  /// Pulses of one full step of each axis; 0: no stepper.
  Eigen::Vector2d full_step_pulses{0, 0};
  bool has_table{};  ///< A correction table belongs to the head.
};

/// How far the machine may be from its data sheet, one standard deviation each: the tolerances of a machine
/// that service has set up. A cause is as uncertain as these make it.
struct MachineSpread {
  double head_offset_mm{0.015};  ///< Place of the field, along each axis.
  double head_rotation_rad{4e-5};
  double head_scale{4e-5};  ///< Scale of each axis.
  double head_shear_rad{4e-5};
  double head_bend_mm{0.004};  ///< Bend of the field, quadratic and cubic, at kBendAt_mm from its middle.
  double lag_s{3e-6};          ///< Delay of each axis.
  double backlash_mm{0.002};   ///< Full play of each axis.
  double mark_mm{0.007};       ///< Place of the print mark's sensor, one error for all units.
  double unit_mark_mm{0.004};  ///< The same from unit to unit.
  double encoder_scale{3e-5};
};

/// The head at one time: where the pulses led it, less the tracking delay. W.
struct HeadState {
  double time_s{kUnknown};
  Eigen::Vector2d p_mm{kUnknown, kUnknown};
  Eigen::Vector2d v_mm_s{0, 0};
  Eigen::Vector2d a_mm_s2{0, 0};
  /// Flank of a small play on which each axis stands, by its last motion: 1 moved forwards, -1 backwards.
  Eigen::Vector2d flank{0, 0};
  Eigen::Vector2d forward_mm{0, 0};  ///< Way of each axis forwards since the begin.
  [[nodiscard]] bool known() const { return time_s == time_s; }
};

/// The sheet at one time.
struct SheetState {
  double x_mm{};  ///< x_W of the unit's origin.
  double speed_mm_s{};
  double since_mark_mm{};  ///< Travel since the unit's eye mark was at its sensor.
  double off_plan_mm{};    ///< Travel since the unit's first cut, less that at the speed of the plan.
};

/// A place of the drawing in one unit. Offsets are along the left normal of the drawn line, from the line.
struct LineReading {
  int unit{};
  int entity{};
  Eigen::Vector2d p_S_mm{0, 0};
  Eigen::Vector2d normal{0, 0};  ///< Unit vector in S, left of the line.
  double cut_mm{kUnknown};       ///< Offset of the cut, by the kerf camera; NaN: not found there.
  double cut_sigma_mm{};
  double asked_mm{kUnknown};    ///< Offset of the way that the pulses led the beam.
  double program_mm{kUnknown};  ///< Offset of the program that the controller was sent.
  HeadState head;
  SheetState sheet;
  Eigen::Vector2d table_mm{0, 0};  ///< What the head's correction table adds here, W.
};

/// A frame of the spot camera.
struct SpotReading {
  int unit{-1};  ///< -1: no unit was in view.
  HeadState head;
  Eigen::Vector2d away_mm{0, 0};  ///< Spot less the head's place by its pulses, W.
  double sigma_mm{};              ///< Standard uncertainty of each component.
  Eigen::Vector2d table_mm{0, 0};
};

/// One opening of the laser's gate.
struct GateReading {
  int unit{};
  int entity{-1};
  double open_late_s{
      kUnknown};  ///< Behind the instant at which the beam sets off from the begin of its line.
  double close_late_s{kUnknown};  ///< Behind the instant at which it comes to its end.
  double energy_share{
      kUnknown};  ///< Energy by the pins for each mm of the way on the sheet, over the ordered one.
};

/// An axis by its pins and by the controller's words.
struct DriveReading {
  std::string axis;
  double step_mm{};
  std::uint64_t pulses{};
  std::uint64_t setup_violations{}, hold_violations{}, width_violations{}, space_violations{};
  double least_setup_s{}, setup_s{};  ///< Least that was seen, and what the drive asks for.
  double least_hold_s{}, hold_s{};
  double first_violation_s{-1.0};
  std::optional<std::int64_t> told{}, seen{};  ///< Steps at the end by its words and by its pins.
};

/// An entity of a unit as a whole.
struct EntityReading {
  int unit{};
  int entity{};
  double coverage{1.0};  ///< Share that is burnt as its process asks.
  double passes{1.0};    ///< How often the spot went along it.
  bool in_program{true};
  int times_in_program{1};
};

/// The belt by its encoder against the sheet by its printed marks.
struct BeltReading {
  double ratio{1.0};  ///< Travel of the sheet for the travel of the encoder at its data sheet's counts.
  double ratio_sigma{};
  double travel_mm{};  ///< Over which it was seen.
};

struct Evidence {
  MachineFacts machine;
  MachineSpread spread;
  double limit_mm{0.05};  ///< Limit of the path.
  bool passed{}, failed{};
  bool edges_judged{};          ///< The edge of a piece is judged in place of the middle of the kerf.
  double kerf_radius_mm{};      ///< With edges: half of the kerf as measured.
  double ordered_radius_mm{};   ///< Half of the kerf by which the program was compensated; 0: it was not.
  double planned_speed_mm_s{};  ///< Speed of the belt.
  bool sheet_moves{};
  bool encoder_backwards{};  ///< The encoder counts backwards while the line runs forwards.
  double belt_travel_mm{};   ///< Travel of the belt by its encoder, through the whole run.
  int openings{};            ///< Openings of the laser's gate.
  /// Share of the frames with a beam in which there was no spot about where the pulses lead it.
  double beam_unseen{};
  bool burnt_elsewhere{};  ///< The sheet is burnt where nothing is drawn.
  /// Share of the sheet's travel that the pulses follow between begin and end of the cuts, median; 1: all of
  /// it.
  double belt_followed{kUnknown};
  Eigen::Vector2d drawing_centre_mm{0, 0};
  std::optional<PowerSwing> power_swing;  ///< Where a power meter is wired: how the power swings by itself.
  std::vector<LineReading> lines;
  std::vector<SpotReading> spots;
  std::vector<GateReading> gates;
  std::vector<DriveReading> drives;
  std::vector<EntityReading> entities;
  std::optional<BeltReading> belt;
  std::string stop;           ///< Why the controller stopped by itself, in its words; empty: it did not.
  std::string axes;           ///< Sentence on axes that are swapped, reversed or of another scale by far.
  std::string gate_polarity;  ///< Sentence on a gate that is inverted.
  std::string steady_power;   ///< Sentence on a laser that keeps its power where the beam is slow.
  std::string corners;        ///< Sentence on axes that do not follow at corners.
};

}  // namespace kerfbench::diagnose
