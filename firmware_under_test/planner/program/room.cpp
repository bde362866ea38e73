// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "firmware_under_test/planner/program/cross_cut.h"

namespace kerfbench::planner {
namespace {

constexpr double kRounding = 1e-9;

std::string nameOf(const Block& block) {
  return block.entity >= 0 ? fmt::format("E{}", block.entity) : fmt::format("G-code line {}", block.line);
}

/// Takes note of where the beam is.
class BeamRange {
 public:
  explicit BeamRange(RoomNeeded& room) : room_(room) {
    room.low_x_mm = std::numeric_limits<double>::infinity();
    room.high_x_mm = -room.low_x_mm;
  }
  void at(double x_mm, const std::string& mark) {
    if (x_mm < room_.low_x_mm) room_.low_x_mm = x_mm, room_.first = mark;
    if (x_mm > room_.high_x_mm) room_.high_x_mm = x_mm, room_.last = mark;
  }

 private:
  RoomNeeded& room_;
};

/// Runs through one unit; returns the place of its end.
double runThrough(const UnitPath& unit, const UnitLayout& layout, const MachineParameters& machine, double v,
                  BeamRange& range, RoomNeeded& room) {
  // Where the sheet's origin is when the unit begins; the print mark sets x_ref, whatever the speed.
  double origin_x_mm =
      layout.x_ref_mm + v * (layout.catch_up_periods * unit.period_s + machine.tracking_delay_s);
  double x_S_mm = unit.start_S_mm.x();
  for (std::size_t i = 0; i < unit.blocks.size(); ++i) {
    const Block& block = unit.blocks[i];
    const std::string name = nameOf(block);
    origin_x_mm += v * layout.waits[i] * unit.period_s;
    range.at(x_S_mm + origin_x_mm, name);
    for (const Sample& sample : block.samples) {
      origin_x_mm += v * unit.period_s;
      room.fastest_x_mm_s =
          std::max(room.fastest_x_mm_s, std::abs((sample.p_S_mm.x() - x_S_mm) / unit.period_s + v));
      x_S_mm = sample.p_S_mm.x();
      range.at(x_S_mm + origin_x_mm, name);
    }
  }
  return x_S_mm + origin_x_mm;
}

std::string atSpeed(double v, const char* which) {
  return fmt::format("at {:g} mm/s, the {} speed of the belt, ", v, which);
}

}  // namespace

RoomNeeded roomAt(const Solution& solution, const MachineParameters& machine, const JobParameters& job,
                  const Axes& axes, double belt_speed_mm_s) {
  const double v = belt_speed_mm_s;
  RoomNeeded room;
  BeamRange range(room);
  for (int k = 0; k < job.units; ++k) {
    if (v > 0.0 && k >= static_cast<int>(solution.layouts.size())) break;
    const UnitLayout& layout = solution.layoutOf(k);
    range.at(layout.park_W_mm.x(), {});
    Eigen::Vector2d end_W_mm = layout.end_W_mm;
    end_W_mm.x() = runThrough(solution.pathOf(k), layout, machine, v, range, room);
    if (v <= 0.0) continue;
    const UnitLayout& next = solution.layoutOf(k + 1);
    const Reposition back(end_W_mm, v, next.park_W_mm, job, axes);
    const int cycle = layout.catch_up_periods + layout.sheet_periods + back.periods() + kSparePeriods;
    room.least_pitch_mm =
        std::max(room.least_pitch_mm, v * cycle * axes.periodS() - next.x_ref_mm + layout.x_ref_mm);
  }
  return room;
}

std::optional<ClosedFormRoom> closedFormRoom(const std::vector<Segment>& path,
                                             const MachineParameters& machine, const JobParameters& job,
                                             double belt_speed_mm_s) {
  std::optional<CrossCut> cut = crossCutOf(path, machine, job);
  if (!cut) return std::nullopt;
  cut->feed_mm_s = belt_speed_mm_s;
  return ClosedFormRoom{cut->cycleMm(), cut->carriedMm()};
}

std::vector<std::string> beltRangeFaults(const Solution& solution, const MachineParameters& machine,
                                         const JobParameters& job, const Axes& axes) {
  std::vector<std::string> faults;
  const auto check = [&](double v, const char* which) {
    if (!(v > 0.0)) return;
    const RoomNeeded room = roomAt(solution, machine, job, axes, v);
    const double least_mm = machine.field_min_mm[0], most_mm = machine.field_max_mm[0];
    if (room.low_x_mm < least_mm - kRounding)
      faults.push_back(atSpeed(v, which) +
                       fmt::format("{} lies at x_W = {:.3f} mm, the field begins at {:g} mm", room.first,
                                   room.low_x_mm, least_mm));
    if (room.high_x_mm > most_mm + kRounding)
      faults.push_back(atSpeed(v, which) +
                       fmt::format("{} is carried to x_W = {:.3f} mm, the field ends at {:g} mm", room.last,
                                   room.high_x_mm, most_mm));
    if (job.units > 1 && room.least_pitch_mm > job.pitch_mm * (1.0 + kRounding))
      faults.push_back(atSpeed(v, which) +
                       fmt::format("{:.3f} mm of belt pass in a cycle, the pitch is {:g} mm",
                                   room.least_pitch_mm, job.pitch_mm));
    if (room.fastest_x_mm_s > axes.axisLimits().x() * (1.0 + kRounding))
      faults.push_back(atSpeed(v, which) +
                       fmt::format("the beam would go at {:.1f} mm/s along x, the axis makes {:.1f} mm/s",
                                   room.fastest_x_mm_s, axes.axisLimits().x()));
  };
  check(job.belt_min_mm_s, "lowest");
  check(job.belt_max_mm_s, "highest");
  return faults;
}

}  // namespace kerfbench::planner
