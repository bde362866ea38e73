// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/pulses.h"
#include "firmware_under_test/planner/job/target.h"

namespace kerfbench::planner {

class CorrectionTable;
class PowerModel;

/// What the reference controller knows of its machine: data-sheet values typed in by whoever set it up. The
/// twin has its own, and a difference between the two is a fault that the bench must see.
struct MachineParameters {
  enum class Head { kTwoMirror, kGantry, kFTheta };
  Head head{Head::kTwoMirror};
  // Two mirrors (Cheng et al. 2014, eq. 2)
  double throw_mm{};                    ///< L: Y mirror to sheet; > 0.
  double mirror_spacing_mm{};           ///< d; >= 0.
  double mirror_step_rad{};             ///< Mechanical angle of one PUL; f-theta too.
  double mirror_acceleration_rad_s2{};  ///< Acceleration of each mirror, mechanical; 0: never the limit.
                                        ///< f-theta too.
  // Two mirrors and an f-theta lens: x = f 2θx, y = f 2θy; what the real one is off is the table's matter
  double focal_length_mm{};  ///< f; > 0.
  // Gantry
  double gantry_step_mm{};
  // All
  std::shared_ptr<const CorrectionTable>
      correction{};          ///< Table of what the formula leaves; none: nothing is corrected.
  double field_min_mm[2]{};  ///< Reach of the beam in W, x and y.
  double field_max_mm[2]{};
  double tracking_delay_s{};  ///< Delay of mirrors or gantry; the belt is led, and the laser delayed, by it.
  double encoder_count_mm{};  ///< Belt travel of one quadrature count.
  double print_mark_sensor_x_mm{};  ///< In W.
  double feed_step_mm{};     ///< Belt travel of one feed PUL; 0: the controller does not drive the belt.
  double full_power_w{};     ///< At PWM duty 255/255.
  double power_quantum_j{};  ///< Energy for each edge of the power meter; 0: there is none.
  double power_delay_s{};    ///< Until it tells.
  double laser_lag_s{};      ///< Lag of the power behind its control signal: it is sent earlier by this.
  Target target{};           ///< The controller.
  Drives drives{};           ///< What it must give them; an axis that is not there needs nothing.
};

/// JobParameters::jump_radius_mm: let the drawing's size decide.
inline constexpr double kRadiusOfDrawing = -1.0;

struct JobParameters {
  double belt_speed_mm_s{};  ///< > 0 while the board moves, 0 for a resting sheet.
  double mark_speed_mm_s{300};
  double jump_speed_mm_s{450};
  double acceleration_mm_s2{20000};
  double jump_acceleration_mm_s2{0};  ///< Acceleration of jumps and of the way back; 0: as of marks.
  /// Radius of the arcs by which jumps leave one mark and meet the next (S2), so that the beam runs through
  /// without a stop; 0: straight jumps from rest to rest; kRadiusOfDrawing: paperRadiusMm().
  double jump_radius_mm{0};
  /// Power over speed that cuts through, Z1 (S3's P_ua times the spot diameter).
  double cut_energy_j_per_mm{};
  /// Material, laser and wanted depths, by which the laser is controlled instead of cut_energy_j_per_mm and
  /// full_power_w; none: power proportional to speed and to Z.
  std::shared_ptr<const PowerModel> power{};
  bool power_loop{false};  ///< The controller corrects the power by the meter; needs `power` and a meter.
  /// Most change of acceleration in marks and jumps, as the samples show it (Pieces says what joints of
  /// lines and arcs are taken for); 0: no limit. Ways back and catching up know none.
  double jerk_mm_s3{0};
  double half_z{0.5};  ///< Z of half-cut and crease.
  double perforation_cut_mm{3.0};
  double perforation_gap_mm{1.0};
  int units{1};
  double pitch_mm{};       ///< Pitch of the units on the web; unit k lies at x_S = -k * pitch.
  double eye_mark_x_mm{};  ///< Leading edge of the eye mark in S of a unit.
  bool alternate{false};   ///< Odd units are cut in reverse (S0: the next cut runs back).
  /// The controller drives the belt with feed steps: the program is timed, waits for no mark and does not
  /// follow.
  bool feed_by_controller{false};
  /// S0's semi-continuous way: the controller feeds one pitch at belt_speed_mm_s, stops the belt, cuts, and
  /// so on.
  bool stop_and_go{false};
  /// x_W of unit 0's origin while the belt rests: at belt speed 0, or before the feed starts.
  double web_start_x_mm{};
  double feed_acceleration_mm_s2{
      500};  ///< Acceleration of the belt's ramps at start and end, feed_by_controller.
  /// The order in which a dieline is cut: the shortest air path that is found, a walk to the nearest end, or
  /// as drawn. All but the last keep creases before cuts and holes before outlines.
  enum class Order { kShortest, kNearest, kDrawn };
  Order order{Order::kShortest};
  /// Half the width of the cut, by which the beam runs beside the lines of process cut so that their edges
  /// lie on the dieline (kerf.h); 0: the beam runs on the lines. Creases, half-cuts and perforations have no
  /// edge to keep and are never moved.
  double kerf_radius_mm{};
  /// Which side of an open cut the beam takes, as seen along it as drawn.
  enum class OpenCuts { kOnTheLine, kLeft, kRight };
  OpenCuts open_cuts{OpenCuts::kOnTheLine};
  /// Cut what can be cut of features smaller than the kerf, rather than refuse.
  bool allow_lost_features{false};
};

/// Acceleration of jumps, as told or as that of marks.
inline double jumpAcceleration(const JobParameters& job) {
  return job.jump_acceleration_mm_s2 > 0.0 ? job.jump_acceleration_mm_s2 : job.acceleration_mm_s2;
}

/// Deliberate mistakes, for releases that the bench must fail.
struct PlannerFaults {
  bool ignore_belt{false};  ///< x' = x, without v t.
  /// x' = x + v t with the speed planned for and nothing else: the belt encoder tells when to begin, and is
  /// not followed then. The third regime of Hu, Hu, Jiang 2014 with v the mean over the cut, taken literally.
  bool mean_speed{false};
  /// x = L tan 2θx instead of (sqrt(L² + y²) + d) tan 2θx, and no correction table.
  bool no_pincushion{false};
  int skip_entity{-1};          ///< Never cut; makeGcode leaves it out.
  int repeat_entity{-1};        ///< Cut twice; makeGcode writes it again at the end.
  bool no_mirror_limit{false};  ///< Nobody heeds MachineParameters::mirror_acceleration_rad_s2.
  bool constant_power{false};   ///< Gives each mark the power of its speed, ramps or not.
  bool kerf_wrong_side{false};  ///< Compensation runs inside of outlines and outside of holes.
  /// Nobody checks that the head is back before the next unit: it comes late, and starts the cut late.
  bool return_unchecked{false};
};

/// A job that cannot be done; what() lists every reason, and the highest belt speed if that is one.
class PlanError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace kerfbench::planner
