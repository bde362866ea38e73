// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/signature.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::diagnose {
namespace {

using Eigen::Vector2d;

/// What neighbours 2 mm apart do not share: rounding of G-code; steps and the sheet's pose; grain of the
/// board, ripple of drives and flutter.
constexpr double kProgramSigma_mm = 0.001;
constexpr double kControllerSigma_mm = 0.005;
constexpr double kMachineSigma_mm = 0.006;
constexpr double kSpotSigma_mm = 0.012;
/// An axis that rests along a line stands on a whole step, up to half of one off: uniform, so step /
/// sqrt(12).
constexpr double kWholeStep = 0.289;
/// Place at which MachineSpread::head_bend_mm is stated.
constexpr double kBendAt_mm = 50.0;

/// `curvature`: of the drawn line, 1/mm. Far beside a bend the normal meets the way elsewhere.
void addLine(const LineReading& line, double curvature, std::vector<Row>& rows) {
  Row row;
  row.along = line.normal;
  row.p_S_mm = line.p_S_mm;
  row.head = line.head;
  row.sheet = line.sheet;
  row.table_mm = line.table_mm;
  row.unit = line.unit;
  row.entity = line.entity;
  const bool has_program = std::isfinite(line.program_mm);
  const auto add = [&](Stage stage, double y_mm, double sigma_mm) {
    row.stage = stage;
    row.y_mm = y_mm;
    row.sigma_mm = std::hypot(sigma_mm, curvature * y_mm * y_mm);
    rows.push_back(row);
  };
  // The program is the same for all units.
  if (has_program && line.unit == 0) add(Stage::kProgram, line.program_mm, kProgramSigma_mm);
  if (!std::isfinite(line.asked_mm) || !line.head.known()) return;
  add(Stage::kController, line.asked_mm - (has_program ? line.program_mm : 0.0), kControllerSigma_mm);
  if (std::isfinite(line.cut_mm))
    add(Stage::kMachine, line.cut_mm - line.asked_mm, std::hypot(line.cut_sigma_mm, kMachineSigma_mm));
}

/// Signatures of a displacement of the whole sheet, about the drawing's middle.
void ofProgram(const Evidence& evidence, std::vector<Signature>& list) {
  const Vector2d c = evidence.drawing_centre_mm;
  const auto add = [&](const char* key, const std::function<Vector2d(const Vector2d&)>& at) {
    list.push_back({key, Stage::kProgram, 0.0, [at, c](const Row& row) { return at(row.p_S_mm - c); }});
  };
  add("program_x", [](const Vector2d&) { return Vector2d(1.0, 0.0); });
  add("program_y", [](const Vector2d&) { return Vector2d(0.0, 1.0); });
  add("program_rotation", [](const Vector2d& p) { return Vector2d(-p.y(), p.x()); });
  add("program_scale", [](const Vector2d& p) { return p; });
  add("program_scale_x", [](const Vector2d& p) { return Vector2d(p.x(), 0.0); });
  add("program_scale_y", [](const Vector2d& p) { return Vector2d(0.0, p.y()); });
  add("program_shear", [](const Vector2d& p) { return Vector2d(p.y(), 0.0); });
}

/// Errors that all readings of one line share.
void ofLines(const Evidence& evidence, std::vector<Signature>& list) {
  std::set<std::pair<int, int>> lines;
  for (const LineReading& line : evidence.lines) lines.insert({line.unit, line.entity});
  const double step_mm = kWholeStep * evidence.machine.step_mm.maxCoeff();
  for (const auto& [unit, entity] : lines)
    list.push_back({fmt::format("line_{}_{}", unit, entity), Stage::kController, step_mm,
                    [unit = unit, entity = entity](const Row& row) {
                      return Vector2d(row.unit == unit && row.entity == entity ? row.along
                                                                               : Vector2d(0.0, 0.0));
                    }});
}

void ofController(const Evidence& evidence, std::vector<Signature>& list) {
  const MachineSpread& spread = evidence.spread;
  const auto add = [&](const char* key, double usual, std::function<Vector2d(const Row&)> at) {
    list.push_back({key, Stage::kController, usual, std::move(at)});
  };
  // Only a sheet that moves has a place that the controller looks for.
  const double mark_mm = evidence.sheet_moves ? spread.mark_mm : 0.002;
  add("mark", mark_mm, [](const Row&) { return Vector2d(1.0, 0.0); });
  add("controller_y", 0.002, [](const Row&) { return Vector2d(0.0, 1.0); });
  add("step", 0.0, [](const Row& row) { return row.head.p_mm; });
  add("step_x", 0.0, [](const Row& row) { return Vector2d(row.head.p_mm.x(), 0.0); });
  add("step_y", 0.0, [](const Row& row) { return Vector2d(0.0, row.head.p_mm.y()); });
  if (!evidence.machine.gantry) {
    const MachineFacts machine = evidence.machine;
    add("pincushion", 0.0,
        [machine](const Row& row) { return withoutPincushion_mm(machine, row.head.p_mm); });
  }
  if (evidence.machine.has_table) add("table", 0.0, [](const Row& row) { return row.table_mm; });
  // Pulses that get lost now and then in one sense: what is lost of them goes with the way that is gone in
  // it.
  add("leak_x_forward", 0.0, [](const Row& row) { return Vector2d(row.head.forward_mm.x(), 0.0); });
  add("leak_x_back", 0.0,
      [](const Row& row) { return Vector2d(row.head.forward_mm.x() - row.head.p_mm.x(), 0.0); });
  add("leak_y_forward", 0.0, [](const Row& row) { return Vector2d(0.0, row.head.forward_mm.y()); });
  add("leak_y_back", 0.0,
      [](const Row& row) { return Vector2d(0.0, row.head.forward_mm.y() - row.head.p_mm.y()); });
  if (!evidence.sheet_moves) return;
  add("encoder", spread.encoder_scale, [](const Row& row) { return Vector2d(row.sheet.since_mark_mm, 0.0); });
  add("latency", 0.0, [](const Row& row) { return Vector2d(-row.sheet.speed_mm_s, 0.0); });
  add("plan_speed", 0.0, [](const Row& row) { return Vector2d(-row.sheet.off_plan_mm, 0.0); });
  int units = 0;
  for (const LineReading& line : evidence.lines) units = std::max(units, line.unit + 1);
  for (int unit = 0; unit < units; ++unit)
    add(fmt::format("mark_of_{}", unit).c_str(), spread.unit_mark_mm,
        [unit](const Row& row) { return Vector2d(row.unit == unit ? 1.0 : 0.0, 0.0); });
}

void ofMachine(const Evidence& evidence, std::vector<Signature>& list) {
  const MachineSpread& spread = evidence.spread;
  const auto add = [&](const char* key, double usual, std::function<Vector2d(const Row&)> at) {
    list.push_back({key, Stage::kMachine, usual, std::move(at)});
  };
  add("head_x", spread.head_offset_mm, [](const Row&) { return Vector2d(1.0, 0.0); });
  add("head_y", spread.head_offset_mm, [](const Row&) { return Vector2d(0.0, 1.0); });
  add("head_rotation", spread.head_rotation_rad,
      [](const Row& row) { return Vector2d(-row.head.p_mm.y(), row.head.p_mm.x()); });
  add("head_scale", 0.0, [](const Row& row) { return row.head.p_mm; });
  add("head_scale_x", spread.head_scale, [](const Row& row) { return Vector2d(row.head.p_mm.x(), 0.0); });
  add("head_scale_y", spread.head_scale, [](const Row& row) { return Vector2d(0.0, row.head.p_mm.y()); });
  add("head_shear", spread.head_shear_rad, [](const Row& row) { return Vector2d(-row.head.p_mm.y(), 0.0); });
  add("lag", 0.0, [](const Row& row) { return Vector2d(-row.head.v_mm_s); });
  add("lag_x", spread.lag_s, [](const Row& row) { return Vector2d(-row.head.v_mm_s.x(), 0.0); });
  add("lag_y", spread.lag_s, [](const Row& row) { return Vector2d(0.0, -row.head.v_mm_s.y()); });
  add("sway", 0.0, [](const Row& row) { return Vector2d(-row.head.a_mm_s2); });
  add("backlash_x", spread.backlash_mm,
      [](const Row& row) { return Vector2d(-0.5 * row.head.flank.x(), 0.0); });
  add("backlash_y", spread.backlash_mm,
      [](const Row& row) { return Vector2d(0.0, -0.5 * row.head.flank.y()); });
  if (evidence.machine.has_table) add("head_table", 0.0, [](const Row& row) { return row.table_mm; });
  // Bends of the field: a table of another head leaves them.
  for (int axis = 0; axis < 2; ++axis) {
    for (int order = 2; order <= 3; ++order) {
      for (int i = 0; i <= order; ++i) {
        const double usual = evidence.machine.gantry ? 0.0 : spread.head_bend_mm;
        add(fmt::format("bend_{}{}{}", axis == 0 ? "x" : "y", order, i).c_str(), usual,
            [axis, order, i](const Row& row) {
              const Vector2d p = row.head.p_mm / kBendAt_mm;
              const double size = std::pow(p.x(), order - i) * std::pow(p.y(), i);
              return axis == 0 ? Vector2d(size, 0.0) : Vector2d(0.0, size);
            });
      }
    }
  }
}

}  // namespace

std::vector<Row> rowsOf(const Evidence& evidence) {
  std::vector<Row> rows;
  const LineReading* before = nullptr;
  for (const LineReading& line : evidence.lines) {
    const bool goes_on = before != nullptr && before->unit == line.unit && before->entity == line.entity;
    double bend_per_mm = 0.0;
    if (goes_on) {
      const double way_mm = (line.p_S_mm - before->p_S_mm).norm();
      if (way_mm > 0.0) bend_per_mm = (line.normal - before->normal).norm() / way_mm;
    }
    addLine(line, bend_per_mm, rows);
    before = &line;
  }
  for (const SpotReading& spot : evidence.spots) {
    for (int axis = 0; axis < 2; ++axis) {
      Row row;
      row.stage = Stage::kMachine;
      row.y_mm = spot.away_mm[axis];
      row.sigma_mm = std::hypot(spot.sigma_mm, kSpotSigma_mm);
      row.along = Vector2d::Unit(axis);
      row.head = spot.head;
      row.table_mm = spot.table_mm;
      row.unit = spot.unit;
      row.of_spot = true;
      rows.push_back(row);
    }
  }
  return rows;
}

Vector2d withoutPincushion_mm(const MachineFacts& machine, const Vector2d& p_W_mm) {
  // The controller aims by x' / L; the beam lands at the reach of the row, by which p_W is where it landed.
  const double reach_mm = std::hypot(machine.throw_mm, p_W_mm.y()) + machine.spacing_mm;
  return {p_W_mm.x() * (1.0 - machine.throw_mm / reach_mm), 0.0};
}

std::vector<Signature> signaturesOf(const Evidence& evidence) {
  std::vector<Signature> list;
  ofProgram(evidence, list);
  ofController(evidence, list);
  ofMachine(evidence, list);
  ofLines(evidence, list);
  return list;
}

Signature stepAt(Stage stage, int axis, double time_s) {
  return {fmt::format("{}_step_{}", stage == Stage::kMachine ? "head" : "pulses", axis == 0 ? "x" : "y"),
          stage, 0.0, [axis, time_s](const Row& row) {
            const double after = row.head.time_s > time_s ? 1.0 : 0.0;
            return axis == 0 ? Vector2d(after, 0.0) : Vector2d(0.0, after);
          }};
}

}  // namespace kerfbench::diagnose
