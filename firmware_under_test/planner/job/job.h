// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/parameter_names.h"
#include "firmware_under_test/planner/job/pulses.h"
#include "firmware_under_test/planner/job/target.h"
#include "firmware_under_test/planner/job/typed_list.h"

namespace kerfbench::planner {

class CorrectionTable;
class PowerModel;

/// Stepper motors on the axes of a head with subdivision drives, as their data sheets have them: what the
/// planner needs to lead the rotor and not only its field (head/stepper.h).
struct StepperMotors {
  double full_step_pulses{};  ///< Pulses for a full step; 0: no stepper, or nothing known of it.
  /// Detent torque over holding torque, -0.5 … 0.5; negative: the motor wakes half of a full step beside the
  /// place to which the magnets pull it without current.
  double detent_share{};
  double resonance_hz{};       ///< Frequency at which the rotor swings in its field; 0: not known.
  double resonance_damping{};  ///< Share of critical, 0 … 0.9.
};

/// Configuration of the reference controller for its machine: data-sheet values that the operator typed in.
/// The twin has its own values, and a difference between the two is a fault that the bench must see.
struct MachineParameters {
  enum class Head { kTwoMirror, kGantry, kFTheta };
  Head head{Head::kTwoMirror};
  // Two mirrors (Cheng et al. 2014, eq. 2)
  double throw_mm{};           ///< Throw L: Y mirror to sheet; > 0.
  double mirror_spacing_mm{};  ///< Distance d of the mirrors; >= 0.
  double mirror_step_rad{};    ///< Mechanical angle of one PUL; also with an f-theta lens.
  /// Mechanical acceleration of each mirror; 0: never the limit. Also with an f-theta lens.
  double mirror_acceleration_rad_s2{};
  StepperMotors steppers{};  ///< Motors of both mirrors.
  // Two mirrors and an f-theta lens: x = f 2θx, y = f 2θy; the table corrects deviations of the real lens.
  double focal_length_mm{};  ///< Focal length f; > 0.
  // Gantry
  double gantry_step_mm{};
  // All heads
  /// Correction table of what the formula leaves; none: nothing is corrected.
  std::shared_ptr<const CorrectionTable> correction{};
  double field_min_mm[2]{};  ///< Reach of the beam in W, x and y.
  double field_max_mm[2]{};
  /// Delay of mirrors or gantry; the beam leads the belt by it, and the laser is delayed by it.
  double tracking_delay_s{};
  double encoder_count_mm{};        ///< Belt travel of one quadrature count.
  double print_mark_sensor_x_mm{};  ///< Place of the print-mark sensor in W.
  double feed_step_mm{};     ///< Belt travel of one feed PUL; 0: the controller does not drive the belt.
  double full_power_w{};     ///< Power at PWM duty 255/255.
  double power_quantum_j{};  ///< Energy for each edge of the power meter; 0: there is none.
  double power_delay_s{};    ///< Delay from emission to the meter's edge.
  double laser_lag_s{};      ///< Lag of the power behind its control signal, which is sent earlier by this.
  Target target{};           ///< The controller.
  /// Requirements of the drives on their pulses; an axis that does not exist requires nothing.
  Drives drives{};
};

/// Value of JobParameters::jump_radius_mm: the size of the drawing decides.
inline constexpr double kRadiusOfDrawing = -1.0;
/// Length of run-ups as the ramp to the speed of marks takes it.
inline constexpr double kRunUpOfSpeed = -1.0;

struct JobParameters {
  double belt_speed_mm_s{};  ///< Speed of the belt; > 0 while the board moves, 0 for a resting sheet.
  /// Lowest and highest speed that the belt may have, S0's v_min and v_max; 0: not told, and not checked.
  double belt_min_mm_s{}, belt_max_mm_s{};
  double mark_speed_mm_s{300};
  double jump_speed_mm_s{450};
  double acceleration_mm_s2{20000};
  double jump_acceleration_mm_s2{0};  ///< Acceleration of jumps and of the return; 0: as of marks.
  /// Radius of the arcs that lead jumps out of one mark and into the next (S2), so that the beam runs through
  /// without a stop; 0: straight jumps from rest to rest; kRadiusOfDrawing: paperRadiusMm().
  double jump_radius_mm{0};
  /// Length by which the beam comes from before a mark, and goes on behind it, along its tangent with the
  /// laser off, so that marks begin and end at speed (sky writing); 0: none; kRunUpOfSpeed. With straight
  /// jumps alone.
  double run_up_mm{0};
  /// Power over speed that cuts through, Z1 (S3's P_ua times the spot diameter).
  double cut_energy_j_per_mm{};
  /// Model of material, laser and wanted depths that controls the laser instead of cut_energy_j_per_mm and
  /// full_power_w; none: power proportional to speed and to Z.
  std::shared_ptr<const PowerModel> power{};
  /// True if the controller corrects the power by the meter; needs `power` and a meter.
  bool power_loop{false};
  /// Law of that loop: damped, as far from ringing as the delay of the meter asks, or the paper's own gain of
  /// 1 (planner/power/loop.h).
  enum class PowerLaw { kDamped, kPaper };
  PowerLaw power_law{PowerLaw::kDamped};
  /// Largest change of acceleration in marks and jumps, in the samples (see Pieces for the joints of lines
  /// and arcs); 0: no limit. Returns and the catch-up with the sheet are not limited.
  double jerk_mm_s3{0};
  /// Largest distance of the beam from a corner as drawn, lag of the drives included, so that it need not
  /// stop there (motion/rounding.h); corners of a right angle and more stay sharp. 0: not stated; corners are
  /// not rounded, and are run through as fast as a period can turn the beam.
  double corner_error_mm{0.005};
  double half_z{0.5};  ///< Z of half-cut and crease.
  double perforation_cut_mm{3.0};
  double perforation_gap_mm{1.0};
  int units{1};
  double pitch_mm{};       ///< Pitch of the units on the web; unit k lies at x_S = -k * pitch.
  double eye_mark_x_mm{};  ///< Leading edge of the eye mark in S of a unit.
  bool alternate{false};   ///< True if odd units are cut in reverse (S0: the next cut runs back).
  /// True if the controller drives the belt with feed steps: the program is timed, waits for no mark and does
  /// not follow.
  bool feed_by_controller{false};
  /// True if the controller follows a belt that runs by itself with its own clock, at the nominal speed: x' =
  /// x + v t (Cheng, Cui, Zhang 2014, eq. 3), t from the print mark. It reads no encoder.
  bool belt_by_clock{false};
  /// True for S0's semi-continuous method: the controller feeds one pitch at belt_speed_mm_s, stops the belt,
  /// cuts, and so on.
  bool stop_and_go{false};
  /// Place x_W of unit 0's origin while the belt rests: at belt speed 0, or before the feed starts.
  double web_start_x_mm{};
  /// Acceleration of the belt's ramps at start and end, with feed_by_controller.
  double feed_acceleration_mm_s2{500};
  /// Order in which a dieline is cut: the shortest air path that is found, a walk to the nearest end, as
  /// drawn, or as given. The first two keep creases before cuts and holes before outlines.
  enum class Order { kShortest, kNearest, kDrawn, kGiven };
  Order order{Order::kShortest};
  std::vector<int> given_order{};  ///< For kGiven: each entity that is cut, by its id, once.
  /// Half the width of the cut: offset of the beam from the lines of process cut, so that the cut's edges lie
  /// on the dieline (kerf.h); 0: the beam runs on the lines. Creases, half-cuts and perforations have no edge
  /// to keep and are never moved.
  double kerf_radius_mm{};
  /// Side of an open cut that the beam takes, as seen along the cut as drawn.
  enum class OpenCuts { kOnTheLine, kLeft, kRight };
  OpenCuts open_cuts{OpenCuts::kOnTheLine};
  /// Entities of which features smaller than the kerf may be lost; what lies between several needs all of
  /// them.
  EntityRanges allow_lost{};
  /// Who gave all this: faults speak of options, or of keys.
  GivenBy given_by{GivenBy::kScenario};
};

/// Acceleration of jumps as configured, or else that of marks.
inline double jumpAcceleration(const JobParameters& job) {
  return job.jump_acceleration_mm_s2 > 0.0 ? job.jump_acceleration_mm_s2 : job.acceleration_mm_s2;
}

/// Deliberate mistakes, for releases that the bench must fail.
struct PlannerFaults {
  bool ignore_belt{false};  ///< Uses x' = x, without v t.
  /// Uses x' = x + v t with the planned speed and nothing else: the belt encoder starts the unit, and is not
  /// followed then. The third regime of Hu, Hu, Jiang 2014 with v the mean over the cut, taken literally.
  bool mean_speed{false};
  /// Uses x = L tan 2θx instead of (sqrt(L² + y²) + d) tan 2θx, and no correction table.
  bool no_pincushion{false};
  int skip_entity{-1};          ///< Entity that is never cut; makeGcode leaves it out.
  int repeat_entity{-1};        ///< Entity that is cut twice; makeGcode writes it again at the end.
  bool no_mirror_limit{false};  ///< Ignores MachineParameters::mirror_acceleration_rad_s2.
  bool constant_power{false};   ///< Gives each mark the power of its nominal speed, ramps or not.
  bool kerf_wrong_side{false};  ///< Compensates inside of outlines and outside of holes.
  /// Omits the check that the head is back before the next unit: it comes late, and starts the cut late.
  bool return_unchecked{false};
};

/// A job that cannot be done; what() lists every reason, and the highest belt speed if that is one.
class PlanError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace kerfbench::planner
