// SPDX-License-Identifier: Apache-2.0
// Is every number of the evidence a number?
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "twin/base/constants.h"

namespace kerfbench::inspect::checks {
namespace {

/// Counts what is no number, and remembers where the first was.
class Numbers {
 public:
  void need(double value, const char* what) {
    if (!std::isfinite(value)) miss(what);
  }
  template <typename Derived>
  void need(const Eigen::MatrixBase<Derived>& values, const char* what) {
    if (!values.allFinite()) miss(what);
  }
  /// What was not measured is NaN; infinity is never right.
  void needUnless(bool not_measured, double value, const char* what) {
    if (std::isinf(value) || (!not_measured && std::isnan(value))) miss(what);
  }
  /// A time of which nothing was seen is infinite.
  void needTime(double value, const char* what) {
    if (std::isnan(value) || value < 0.0) miss(what);
  }
  [[nodiscard]] std::vector<std::string> problems() const {
    if (count_ == 0) return {};
    return {fmt::format("{} readings of the evidence are no numbers, the first is {}.", count_, first_)};
  }

 private:
  void miss(const char* what) {
    if (count_++ == 0) first_ = what;
  }
  std::size_t count_{};
  const char* first_{};
};

void addSpot(const vision::SpotTrack& track, Numbers& n) {
  for (const vision::FrameMeasurement& frame : track.frames) {
    n.need(frame.mid_s, "the time of a frame");
    if (frame.spot_W_mm) {
      n.need(*frame.spot_W_mm, "the place of a spot");
      n.need(frame.spot_sigma_mm, "the uncertainty of a spot");
    }
    for (const vision::SheetPose& pose : frame.sheet) {
      n.need(pose.p_WS_mm, "the place of the sheet in a frame");
      n.need(pose.angle_rad, "the angle of the sheet in a frame");
      n.need(pose.covariance, "the covariance of the sheet's place in a frame");
      n.needUnless(pose.marks < 2, pose.residual_mm, "the residual of the marks in a frame");
    }
  }
}

void addKerf(const vision::KerfScan& scan, Numbers& n) {
  n.need(scan.table_sigma_mm, "the repeatability of the inspection table");
  n.need(scan.scale_sigma, "the uncertainty of the inspection's scale");
  for (const vision::EntityKerf& kerf : scan.entities) {
    n.need(kerf.depth_mm, "the depth at which a kerf is seen");
    n.need(kerf.depth_sigma_mm, "the uncertainty of the depth at which a kerf is seen");
    for (const vision::Caliper& c : kerf.calipers) {
      n.need(c.u, "the place of a caliper");
      n.need(c.station_mm, "the station of a caliper");
      n.need(c.p_S_mm, "the place of a caliper");
      n.need(c.p_V_mm, "the place of a caliper in the picture");
      n.need(c.brightness, "the brightness of a kerf");
      const bool moot = !c.found || c.near_joint;
      n.needUnless(moot, c.offset_mm, "the offset of a kerf");
      n.needUnless(moot, c.sigma_mm, "the uncertainty of a kerf's offset");
      n.needUnless(moot, c.steady_sigma_mm, "the part of it that neighbours share");
      n.needUnless(moot, c.width_mm, "the width of a kerf");
      n.needUnless(moot, c.width_sigma_mm, "the uncertainty of a kerf's width");
    }
  }
  for (const vision::CornerKerf& corner : scan.corners) {
    n.need(corner.p_S_mm, "the place of a corner");
    n.need(corner.turn_rad, "the turn of a corner");
    n.needUnless(!corner.found, corner.deviation_mm, "the deviation at a corner");
    n.needUnless(!corner.found, corner.rounding_mm, "the rounding of a corner");
    n.needUnless(!corner.found, corner.overshoot_mm, "the overshoot of a corner");
    n.needUnless(!corner.found, corner.deviation_sigma_mm, "the uncertainty of the deviation at a corner");
    n.needUnless(!corner.found, corner.rounding_sigma_mm, "the uncertainty of the rounding of a corner");
    n.needUnless(!corner.found, corner.overshoot_sigma_mm, "the uncertainty of the overshoot of a corner");
  }
  for (const vision::LineEnd& end : scan.ends) {
    n.needUnless(!end.found, end.gap_mm, "the gap at the end of a line");
    n.needUnless(!end.found, end.sigma_mm, "the uncertainty of the end of a line");
  }
  for (const vision::UnitPose& pose : scan.units) {
    n.need(pose.p_TS_mm, "the place of a unit on the table");
    n.need(pose.angle_rad, "the angle of a unit on the table");
    n.need(pose.covariance, "the covariance of a unit's place on the table");
    n.needUnless(pose.marks < 2, pose.residual_mm, "the residual of a unit's marks");
  }
  for (const vision::StrayCut& stray : scan.strays) {
    n.need(stray.p_S_mm, "the place of a stray cut");
    n.need(stray.extent_mm, "the extent of a stray cut");
  }
  n.need(scan.mark_residual_mm, "the residual of the marks on the table");
}

void addPins(const Evidence& evidence, Numbers& n) {
  for (const PulseTiming& t : evidence.pulses) {
    for (const double s : {t.profile.setup_s, t.profile.hold_s, t.profile.width_s, t.profile.space_s,
                           t.profile.enable_setup_s})
      n.need(s, "a time that a drive asks for");
    for (const double s : {t.min_setup_s, t.min_hold_s, t.min_width_s, t.min_space_s, t.min_enable_setup_s})
      n.needTime(s, "a time of a pulse");
    n.need(t.first_violation_s, "the time of a violation");
  }
  for (const GateInterval& gate : evidence.gates) {
    n.need(gate.on_s, "the time at which the gate opened");
    n.need(gate.off_s, "the time at which the gate closed");
  }
  if (evidence.end) {
    n.need(evidence.end->time_s, "the time at which the controller told its end");
    n.need(evidence.end->last_pulse_s, "the time of the last pulse");
  }
  double last_s = -std::numeric_limits<double>::infinity();
  for (const BeltEdge& edge : evidence.belt) {
    n.need(edge.time_s >= last_s ? edge.time_s : kNan, "the time of an edge of the belt's encoder");
    n.need(edge.x_mm, "the place of the belt");
    last_s = edge.time_s;
  }
  last_s = -std::numeric_limits<double>::infinity();
  for (const double edge_s : evidence.power_edges_s) {
    n.need(edge_s >= last_s ? edge_s : kNan, "the time of an edge of the power meter");
    last_s = edge_s;
  }
  n.need(evidence.power_quantum_j, "the energy of an edge of the power meter");
  n.need(evidence.belt_count_mm, "the travel of a count of the belt's encoder");
  n.need(evidence.pin_u_s, "the uncertainty of a pin's time");
  n.need(evidence.clock_bound_s, "the bound of the camera's clock");
}

void addCalibration(const std::optional<vision::CameraCalibration>& calibration, Numbers& n) {
  if (!calibration) return;
  const vision::CameraCalibration& c = *calibration;
  for (const double v :
       {c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.map_u_mm, c.rms_px, c.telecentric_mm, c.square_within_rad})
    n.need(v, "a value of a camera's calibration");
  for (const double v : c.distortion) n.need(v, "the distortion of a camera's calibration");
  n.need(c.X_CP.matrix(), "the pose of a camera's calibration");
  n.need(c.area_mm.min(), "the area of a camera's calibration");
  n.need(c.area_mm.max(), "the area of a camera's calibration");
  for (const auto& mode : c.error_modes) n.need(mode, "the covariance of a camera's calibration");
}

void addOrder(const Evidence& evidence, const Tolerances& limits, Numbers& n) {
  n.need(evidence.print.pitch_mm, "the pitch of the print");
  for (const RegistrationMark& mark : evidence.print.marks) {
    n.need(mark.p_SM_mm, "the place of a registration mark");
    n.need(mark.diameter_mm, "the diameter of a registration mark");
  }
  for (const dieline::Entity& entity : evidence.dieline->entities) {
    n.need(dieline::lengthOf(entity.curve), "the length of an entity");
    for (const double u : {0.0, 1.0}) n.need(dieline::pointAt(entity.curve, u), "a point of the dieline");
  }
  for (const double v : {limits.path_mm,
                         limits.stillness_mm,
                         limits.uncut_mm,
                         limits.uncut_share,
                         limits.cut_through_mm,
                         limits.dwell_mm,
                         limits.kerf_width_mm,
                         limits.stray_mm,
                         limits.end_gap_mm,
                         limits.passes,
                         limits.gate_tail_s,
                         limits.gate_lag_s,
                         limits.perforation.cut_mm,
                         limits.perforation.bridge_mm,
                         limits.perforation.limit_mm,
                         limits.ordered_width.nominal_mm,
                         limits.ordered_width.limit_mm,
                         limits.crease_depth.least,
                         limits.crease_depth.most,
                         limits.half_cut_depth.least,
                         limits.half_cut_depth.most,
                         limits.even_depth_share,
                         limits.board_transmission,
                         limits.line_energy_j_mm,
                         limits.line_energy_share})
    n.need(v, "a limit");
}

}  // namespace

std::vector<std::string> numberProblems(const Evidence& evidence, const Tolerances& limits) {
  Numbers numbers;
  addSpot(evidence.spot, numbers);
  addKerf(evidence.kerf, numbers);
  addPins(evidence, numbers);
  addCalibration(evidence.spot_calibration, numbers);
  addCalibration(evidence.kerf_calibration, numbers);
  addOrder(evidence, limits, numbers);
  return numbers.problems();
}

}  // namespace kerfbench::inspect::checks
