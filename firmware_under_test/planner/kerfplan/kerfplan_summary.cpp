// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_summary.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/program/room.h"

namespace kerfbench::planner {
namespace {

/// Says which jumps are straight although arcs were wished, and why; empty if none were.
std::string jumpsLine(const JumpsTaken& jumps) {
  using Why = JumpsTaken::Why;
  const std::size_t straight = jumps.straight.size();
  const std::size_t count = straight + static_cast<std::size_t>(jumps.smooth);
  if (count == 0) return {};
  std::string text = fmt::format("  smooth jumps    {} of {}\n", jumps.smooth, count);
  const std::pair<Why, const char*> reasons[] = {
      {Why::kWaits, "the beam waits there for the sheet"},
      {Why::kField, "arcs would leave the field"},
      {Why::kSooner, "on the moving sheet arcs would take too long"},
      {Why::kNoCurve, "no arcs join the marks"},
      {Why::kNoRoom, "on the moving sheet no arcs fit"}};
  for (const auto& [why, reason] : reasons) {
    std::string names;
    int of_these = 0;
    constexpr int kMostNames = 12;
    for (const JumpsTaken::Straight& jump : jumps.straight) {
      if (jump.why != why) continue;
      if (++of_these > kMostNames) continue;
      names += (names.empty() ? "" : ", ") +
               (jump.entity >= 0 ? fmt::format("E{}", jump.entity) : fmt::format("line {}", jump.line));
    }
    if (of_these == 0) continue;
    text += fmt::format("                  {} straight, with stops: {} (before {}{})\n", of_these, reason,
                        names, of_these > kMostNames ? ", …" : "");
  }
  return text;
}

/// Room along the belt: at its speed, and at the lowest and highest that it may have.
std::string roomText(const CheckResult& checked, const std::vector<Segment>& path,
                     const MachineParameters& machine, const JobParameters& job) {
  std::string text;
  const auto add = [&](const std::string& which, double v) {
    const RoomNeeded room = roomAt(*checked.solution, machine, job, Axes(machine, {}), v);
    text += fmt::format("  field along x   {:.3f} … {:.3f} mm of {:g} … {:g} mm{}\n", room.low_x_mm,
                        room.high_x_mm, machine.field_min_mm[0], machine.field_max_mm[0], which);
    if (room.least_pitch_mm > 0.0)
      text += fmt::format("  pitch           {:.3f} mm at least{}{}\n", room.least_pitch_mm,
                          job.units > 1 ? fmt::format(", {:g} mm given", job.pitch_mm) : "", which);
    if (const auto closed = closedFormRoom(path, machine, job, v))
      text += fmt::format("  without ramps   pitch {:.1f} mm, travel {:.1f} mm (Hu, Hu, Jiang 2014){}\n",
                          closed->least_pitch_mm, closed->travel_mm, which);
  };
  add("", speedWhileCutting(job));
  if (job.belt_min_mm_s > 0.0) add(fmt::format(", belt at {:g} mm/s", job.belt_min_mm_s), job.belt_min_mm_s);
  if (job.belt_max_mm_s > 0.0) add(fmt::format(", belt at {:g} mm/s", job.belt_max_mm_s), job.belt_max_mm_s);
  return text;
}

}  // namespace

std::string summaryOf(const std::string& input, const CheckResult& checked, const Plan& plan,
                      const MachineParameters& machine, const JobParameters& job) {
  std::size_t bytes = 0;
  for (const auto& op : plan.program.ops) bytes += op.size();
  std::string text = fmt::format(
      "{}: fits\n"
      "  belt            {:.2f} mm/s, at most {:.2f} mm/s\n"
      "  unit            {:.4f} s, with the way back {:.4f} s\n"
      "  marks / jumps   {:.3f} mm / {:.3f} mm\n"
      "  start           unit 0's origin at x = {:.3f} mm\n"
      "  program         {} operations, {} bytes\n"
      "  controller      {}\n",
      input, job.belt_speed_mm_s, plan.max_belt_speed_mm_s, plan.unit_time_s, plan.cycle_time_s,
      plan.cut_length_mm, plan.jump_length_mm, plan.x_ref_mm, plan.program.ops.size(), bytes,
      describe(machine.target));
  return text + jumpsLine(checked.solution->paths.front().jumps) +
         roomText(checked, unitOf(readGcode(plan.gcode)), machine, job);
}

}  // namespace kerfbench::planner
