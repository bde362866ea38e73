// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/diagnosis_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/geometry.h"
#include "hil/inspect/verdict/controller_end.h"
#include "hil/judge/asked_path.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/gate_readings.h"
#include "hil/judge/pin_wiring.h"
#include "hil/judge/program_path.h"
#include "hil/judge/timed_cuts.h"
#include "hil/run/dialogs.h"

namespace kerfbench::judge {
namespace {

/// Neighbours nearer than this share their errors: grain, steps, the print.
constexpr double kLinePitch_mm = 2.0;
constexpr std::size_t kMostSpots = 1200;
constexpr double kProgramReach_mm = 3.0;
/// Where a whole entity lies farther off: a belt that is not followed.
constexpr double kFar_mm = 40.0;

class EvidenceMaker {
 public:
  EvidenceMaker(const scenario::Case& test_case, const source::PinRecording& recording,
                const inspect::Evidence& pins, const inspect::InspectionResult& result)
      : case_(test_case),
        recording_(recording),
        pins_(pins),
        result_(result),
        table_(scenario::plannerMachine(test_case).correction),
        sheet_(pins.spot, pins.belt, scenario::webOf(test_case).start_x_mm, test_case.scenario.print) {
    machineFacts();
    spread();
    scenarioFacts();
  }

  diagnose::Evidence make() {
    drives();
    beam();
    entities();
    if (out_.sheet_moves) belt();
    if (const auto steps = stepsOf(case_, recording_)) alongPins(*steps);
    return std::move(out_);
  }

 private:
  void machineFacts() {
    const twin::MachineDescription& machine = case_.machine;
    diagnose::MachineFacts& facts = out_.machine;
    facts.gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
    facts.tracking_delay_s = machine.controller.tracking_delay_s;
    facts.encoder_count_mm = machine.belt.encoder.count_mm;
    facts.has_table = table_ != nullptr;
    const twin::AxisDescription& x = facts.gantry ? machine.gantry_x : machine.galvo_x;
    const twin::AxisDescription& y = facts.gantry ? machine.gantry_y : machine.galvo_y;
    for (const auto& [axis, index] : {std::pair{&x, 0}, std::pair{&y, 1}}) {
      if (std::holds_alternative<twin::StepperDescription>(axis->drive))
        facts.full_step_pulses[index] = std::max(1.0, machine.controller.full_step_pulses);
    }
    if (facts.gantry) {
      facts.step_mm = {x.step, y.step};
      return;
    }
    facts.throw_mm = machine.head.throw_mm;
    facts.spacing_mm = machine.head.mirror_spacing_mm;
    facts.mirror_step_urad = 1e6 * x.step;
    // The beam turns by twice the mirror's angle.
    facts.step_mm = {2.0 * x.step * (facts.throw_mm + facts.spacing_mm), 2.0 * y.step * facts.throw_mm};
  }

  void spread() {
    const twin::ImperfectionSpread& from = case_.spread;
    diagnose::MachineSpread& to = out_.spread;
    to.encoder_scale = std::hypot(from.roller_radius, 1e-5);
    to.mark_mm = std::hypot(from.mark_sensor_mm, from.encoder_runout_mm, from.print_mm);
    to.unit_mark_mm = std::hypot(from.mark_jitter_mm, from.encoder_runout_mm, 0.002);
    if (out_.machine.gantry) {
      to.head_offset_mm = std::hypot(from.beam_offset_mm, 0.005);
      to.head_scale = std::hypot(from.scale, 2e-5);
      to.head_shear_rad = std::hypot(from.squareness_rad, 1e-5);
      to.head_rotation_rad = 1e-5;
      to.backlash_mm = 1.5 * from.backlash_mm;
      return;
    }
    const double throw_mm = out_.machine.throw_mm;
    // A mirror turns the beam by twice its own error.
    to.head_offset_mm = std::hypot(2.0 * from.zero_rad * throw_mm, from.beam_tilt_rad * throw_mm,
                                   std::hypot(from.beam_offset_mm, from.surface_offset_mm));
    to.head_rotation_rad = 2.0 * std::hypot(from.axis_tilt_rad, from.beam_tilt_rad);
    to.head_shear_rad = to.head_rotation_rad;
    to.head_scale = std::hypot(from.scale, 2.0 * from.surface_height_mm / throw_mm, from.throw_mm / throw_mm);
    to.lag_s = std::max(2e-6, 1.5 * from.bandwidth * out_.machine.tracking_delay_s);
    to.backlash_mm = 3.0 * from.backlash_rad * throw_mm;
  }

  void scenarioFacts() {
    const scenario::Scenario& scenario = case_.scenario;
    out_.limit_mm = scenario.limits.path_mm;
    out_.passed = result_.verdict == inspect::Verdict::kPass;
    out_.failed = result_.verdict == inspect::Verdict::kFail;
    out_.edges_judged = result_.edges.has_value();
    out_.ordered_radius_mm = scenario.job.kerf_radius_mm;
    out_.planned_speed_mm_s = scenario.belt_speed_mm_s;
    out_.sheet_moves = scenario.sheetMoves() && !scenario.belt_by_controller;
    out_.drawing_centre_mm = case_.dieline->bounds().center();
    // A belt that runs forwards while its encoder counts backwards.
    if (out_.sheet_moves && !pins_.belt.empty() && scenario.belt_speed_mm_s > 0.0 &&
        pins_.belt.back().x_mm < -kFar_mm)
      out_.encoder_backwards = true;
    if (!pins_.belt.empty()) out_.belt_travel_mm = pins_.belt.back().x_mm - pins_.belt.front().x_mm;
    out_.openings = static_cast<int>(pins_.gates.size());
    if (pins_.end && inspect::stoppedByItself(*pins_.end, pins_.gates)) out_.stop = pins_.end->reason;
    double width_mm = 0.0;
    int widths = 0;
    for (const inspect::EntityResult& e : result_.entities) {
      if (!std::isfinite(e.width_mm)) continue;
      width_mm += e.width_mm;
      ++widths;
    }
    if (widths > 0) out_.kerf_radius_mm = 0.5 * width_mm / widths;
  }

  void drives() {
    for (std::size_t i = 0; i < pins_.pulses.size(); ++i) {
      const PulseTiming& t = pins_.pulses[i];
      diagnose::DriveReading drive;
      drive.axis = t.axis;
      if (i < 2) drive.step_mm = out_.machine.step_mm[static_cast<Eigen::Index>(i)];
      drive.pulses = t.pulses;
      drive.setup_violations = t.setup_violations;
      drive.hold_violations = t.hold_violations;
      drive.width_violations = t.width_violations;
      drive.space_violations = t.space_violations;
      drive.least_setup_s = t.min_setup_s;
      drive.setup_s = t.profile.setup_s;
      drive.least_hold_s = t.min_hold_s;
      drive.hold_s = t.profile.hold_s;
      drive.first_violation_s = t.first_violation_s;
      if (pins_.account && pins_.account->told) {
        for (const auto& axis : pins_.account->axes) {
          if (axis.name != t.axis) continue;
          drive.told = axis.told;
          drive.seen = axis.seen;
        }
      }
      out_.drives.push_back(drive);
    }
  }

  void beam() {
    for (const inspect::Check& check : result_.checks) {
      if (check.name == "spot_seen" && std::isfinite(check.value)) out_.beam_unseen = check.value;
      if (check.name == "stray") out_.burnt_elsewhere = check.verdict == inspect::Verdict::kFail;
    }
  }

  void entities() {
    const ProgramPath program(gcode());
    for (const inspect::EntityResult& e : result_.entities) {
      diagnose::EntityReading reading;
      reading.unit = e.unit;
      reading.entity = e.entity;
      if (std::isfinite(e.coverage)) reading.coverage = e.coverage;
      if (std::isfinite(e.passes)) reading.passes = e.passes;
      if (!program.empty()) {
        reading.in_program = program.has(e.entity) || !program.isNamed();
        const double drawn_mm =
            dieline::lengthOf(case_.dieline->entities[static_cast<std::size_t>(e.entity)].curve);
        reading.times_in_program =
            drawn_mm > 0.0 ? static_cast<int>(std::lround(program.lengthOf(e.entity) / drawn_mm)) : 1;
      }
      out_.entities.push_back(reading);
    }
  }

  void belt() {
    out_.belt = sheet_.scale();
    if (!out_.belt) return;
    // The recording counts at what the controller was told that a count is.
    const double told_mm = case_.machine.controller.encoder_count_mm;
    if (told_mm > 0.0) out_.belt->ratio *= told_mm / out_.machine.encoder_count_mm;
  }

  void alongPins(const SharedSteps& steps) {
    const AskedPath asked(steps, placeOfSteps(case_), recording_.rate.seconds(recording_.end),
                          out_.machine.tracking_delay_s);
    const ProgramPath program(gcode());
    const TimedCuts cuts(asked, sheet_, program, pins_.gates,
                         {case_.scenario.print.units, case_.scenario.job.alternate});
    for (const TimedCuts::Cut& cut : cuts.cuts()) {
      const auto first = first_cut_s_.try_emplace(cut.unit, cut.on_s).first;
      first->second = std::min(first->second, cut.on_s);
    }
    if (out_.sheet_moves) out_.belt_followed = beltFollowed(asked, cuts);
    lines(asked, cuts, program);
    spots(asked);
    const scenario::Scenario& scenario = case_.scenario;
    const CutOrder order{case_.machine.laser.full_power_w,
                         scenario.job.power ? 0.0 : scenario.job.cut_energy_j_per_mm,
                         scenario.job.mark_speed_mm_s, scenario.job.acceleration_mm_s2};
    out_.gates = gateReadings(cuts, asked, sheet_, pins_.light, order);
    // Without a meter there is no loop that could ring.
    if (!pins_.power_edges_s.empty()) out_.power_swing = diagnose::powerSwing(powerRuns(cuts, pins_.light));
  }

  /// How far the pulses go along x from begin to end of each piece of the program, less what the piece itself
  /// does.
  [[nodiscard]] double beltFollowed(const AskedPath& asked, const TimedCuts& cuts) const {
    constexpr double kLong_mm = 3.0;
    std::vector<double> shares;
    for (const TimedCuts::Cut& cut : cuts.cuts()) {
      if (cut.piece == nullptr) continue;
      const diagnose::HeadState begin = asked.at(cut.on_s);
      const diagnose::HeadState end = asked.at(cut.off_s);
      const double travel_mm =
          sheet_.at(cut.unit, cut.off_s).p_mm.x() - sheet_.at(cut.unit, cut.on_s).p_mm.x();
      if (!begin.known() || !end.known() || std::abs(travel_mm) < kLong_mm) continue;
      const double piece_mm =
          cut.piece->segments.back().end_mm.x() - cut.piece->segments.front().start_mm.x();
      shares.push_back((end.p_mm.x() - begin.p_mm.x() - (cut.reversed ? -piece_mm : piece_mm)) / travel_mm);
    }
    if (shares.empty()) return diagnose::kUnknown;
    const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
    std::ranges::nth_element(shares, middle);
    return *middle;
  }

  void lines(const AskedPath& asked, const TimedCuts& cuts, const ProgramPath& program) {
    const vision::KerfScan& scan = result_.edges ? *result_.edges : pins_.kerf;
    for (const vision::EntityKerf& kerf : scan.entities) {
      if (static_cast<std::size_t>(kerf.entity) >= case_.dieline->entities.size()) continue;
      const dieline::Curve& curve = case_.dieline->entities[static_cast<std::size_t>(kerf.entity)].curve;
      const std::size_t first = out_.lines.size();
      double next_mm = 0.0;
      for (const vision::Caliper& caliper : kerf.calipers) {
        if (caliper.near_joint || caliper.station_mm < next_mm) continue;
        next_mm = caliper.station_mm + kLinePitch_mm;
        diagnose::LineReading line;
        line.unit = kerf.unit;
        line.entity = kerf.entity;
        line.p_S_mm = caliper.p_S_mm;
        const Eigen::Vector2d tangent = dieline::tangentAt(curve, caliper.u);
        line.normal = {-tangent.y(), tangent.x()};
        if (caliper.found) line.cut_mm = caliper.offset_mm;
        line.cut_sigma_mm = caliper.sigma_mm;
        if (!program.empty())
          line.program_mm = program.offsetAt(kerf.entity, line.p_S_mm, line.normal, kProgramReach_mm);
        timed(asked, cuts, kProgramReach_mm, line);
        out_.lines.push_back(line);
      }
      const auto begin = out_.lines.begin() + static_cast<std::ptrdiff_t>(first);
      const auto unknown =
          std::count_if(begin, out_.lines.end(), [](const auto& l) { return std::isnan(l.asked_mm); });
      // What a release that stopped did not come to lies nowhere.
      if (out_.stop.empty() && 2 * unknown > out_.lines.end() - begin && cuts.paired() &&
          program.has(kerf.entity))
        for (auto line = begin; line != out_.lines.end(); ++line) timed(asked, cuts, kFar_mm, *line);
    }
  }

  void timed(const AskedPath& asked, const TimedCuts& cuts, double reach_mm,
             diagnose::LineReading& line) const {
    const auto passing = cuts.passing(line.unit, line.entity, line.p_S_mm, line.normal, reach_mm);
    if (!passing) return;
    line.asked_mm = passing->offset_mm;
    line.head = asked.at(passing->time_s);
    line.sheet = sheetAt(line.unit, passing->time_s);
    if (table_) line.table_mm = tableAt(line.head.p_mm);
  }

  [[nodiscard]] diagnose::SheetState sheetAt(int unit, double time_s) const {
    diagnose::SheetState state;
    state.x_mm = sheet_.at(unit, time_s).p_mm.x();
    if (!out_.sheet_moves) return state;
    state.speed_mm_s = sheet_.speedAt_mm_s(time_s);
    state.since_mark_mm =
        state.x_mm + case_.scenario.print.eye_mark_x_mm - case_.machine.belt.print_mark_sensor.x_mm;
    if (const auto first = first_cut_s_.find(unit); first != first_cut_s_.end())
      state.off_plan_mm = state.x_mm - sheet_.at(unit, first->second).p_mm.x() -
                          out_.planned_speed_mm_s * (time_s - first->second);
    return state;
  }

  [[nodiscard]] Eigen::Vector2d tableAt(const Eigen::Vector2d& p_W_mm) const {
    const Eigen::Vector2d d = table_->at(p_W_mm).d;
    return table_->unit() == planner::CorrectionTable::Unit::kMm
               ? d
               : Eigen::Vector2d(d.cwiseProduct(out_.machine.step_mm));
  }

  void spots(const AskedPath& asked) {
    std::vector<const vision::FrameMeasurement*> lit;
    for (const vision::FrameMeasurement& frame : pins_.spot.frames)
      if (frame.spot_W_mm && !frame.faults.any()) lit.push_back(&frame);
    const std::size_t stride = lit.size() / kMostSpots + 1;
    const double map_mm = pins_.spot_calibration ? pins_.spot_calibration->map_u_mm : 0.0;
    for (std::size_t i = 0; i < lit.size(); i += stride) {
      const vision::FrameMeasurement& frame = *lit[i];
      diagnose::SpotReading spot;
      spot.head = asked.at(frame.mid_s);
      if (!spot.head.known()) continue;
      spot.away_mm = *frame.spot_W_mm - spot.head.p_mm;
      spot.sigma_mm = std::hypot(frame.spot_sigma_mm, map_mm);
      if (!frame.sheet.empty()) spot.unit = frame.sheet.front().unit;
      if (table_) spot.table_mm = tableAt(spot.head.p_mm);
      out_.spots.push_back(spot);
    }
  }

  /// The program of one unit that the release was sent; planned again, which gives the same. Empty where a
  /// recording is judged by a drawing that cannot be planned: it was sent another one.
  const std::string& gcode() {
    if (gcode_) return *gcode_;
    try {
      gcode_ = run::prepareJob(case_).gcode;
    } catch (const planner::PlanError&) {
      gcode_ = "";
    }
    return *gcode_;
  }

  const scenario::Case& case_;
  const source::PinRecording& recording_;
  const inspect::Evidence& pins_;
  const inspect::InspectionResult& result_;
  std::shared_ptr<const planner::CorrectionTable> table_;
  SheetPath sheet_;
  std::optional<std::string> gcode_;
  std::map<int, double> first_cut_s_;
  diagnose::Evidence out_;
};

}  // namespace

diagnose::Evidence diagnosisEvidence(const scenario::Case& test_case, const source::PinRecording& recording,
                                     const inspect::Evidence& evidence,
                                     const inspect::InspectionResult& result) {
  return EvidenceMaker(test_case, recording, evidence, result).make();
}

}  // namespace kerfbench::judge
