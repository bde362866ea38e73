// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/unit_motion.h"

#include <array>
#include <bit>
#include <utility>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;
using Op = std::vector<std::uint8_t>;

/// Steps, print marks and feed of a program up to an operation.
class OpReader {
 public:
  explicit OpReader(int first_axis) : first_(static_cast<std::size_t>(first_axis)) {}

  /// Returns the power of a period; nothing for a dark one, and for what is no period.
  std::optional<std::uint8_t> take(const Op& op) {
    is_period_ = (op[0] & KB_OP_MOVE) != 0;
    if (op[0] == KB_OP_WAIT_MARK) {
      std::uint32_t bits = 0;
      for (unsigned i = 0; i < 4; ++i) bits |= std::uint32_t{op[1 + i]} << (8 * i);
      mark_offset_ = std::bit_cast<std::int32_t>(bits);
    }
    if (!is_period_) return std::nullopt;
    std::size_t at = 1;
    for (std::size_t axis = 0; axis < KB_AXES; ++axis)
      if ((op[0] & (1U << axis)) != 0) counts_.at(axis) += static_cast<std::int8_t>(op[at++]);
    if ((op[0] & KB_OP_POWER) == 0) return std::nullopt;
    return op[at];
  }

  [[nodiscard]] bool isPeriod() const { return is_period_; }
  [[nodiscard]] Vector2i steps() const { return {counts_.at(first_), counts_.at(first_ + 1)}; }
  [[nodiscard]] int feedSteps() const { return counts_[KB_FEED]; }
  /// Encoder counts behind the last print mark that was waited for.
  [[nodiscard]] std::int32_t markOffset() const { return mark_offset_; }

 private:
  std::size_t first_;
  std::array<int, KB_AXES> counts_{};
  std::int32_t mark_offset_{};
  bool is_period_{};
};

/// What the periods of a unit are for, in their order.
std::vector<UnitPeriod> plannedPeriods(const UnitPath& path, const UnitLayout& layout) {
  std::vector<UnitPeriod> planned;
  const double v = path.belt_speed_mm_s;
  const int first_line = path.blocks.front().samples.front().line;
  for (int k = 1; k <= layout.catch_up_periods; ++k) {
    // Behind the sheet by what it has run less what the beam has, up to where both are at one speed.
    const double u = static_cast<double>(k) / layout.catch_up_periods;
    const double ahead_mm = catchUpMm(1.0, v, layout.catch_up_periods, path.period_s) -
                            catchUpMm(u, v, layout.catch_up_periods, path.period_s);
    const double left_mm = v * (layout.catch_up_periods - k) * path.period_s;
    planned.push_back(
        {.planned_S_mm = path.start_S_mm + Vector2d(left_mm - ahead_mm, 0.0), .line = first_line});
  }
  Vector2d at_mm = path.start_S_mm;
  for (std::size_t i = 0; i < path.blocks.size(); ++i) {
    const Block& block = path.blocks[i];
    const int wait = i < layout.waits.size() ? layout.waits[i] : 0;
    for (int k = 0; k < wait; ++k)
      planned.push_back({.planned_S_mm = at_mm, .line = block.samples.front().line, .entity = block.entity});
    for (const Sample& sample : block.samples) {
      at_mm = sample.p_S_mm;
      planned.push_back({.planned_S_mm = at_mm, .line = sample.line, .entity = block.entity});
    }
  }
  return planned;
}

/// Where the sheet is while a unit runs.
class SheetPlace {
 public:
  SheetPlace(const MachineParameters& machine, const JobParameters& job, int unit)
      : machine_(machine), job_(job), unit_(unit) {
    moves_ = job.belt_speed_mm_s > 0.0 && !job.stop_and_go;
    lead_mm_ = moves_ ? job.belt_speed_mm_s * machine.tracking_delay_s : 0.0;
  }

  [[nodiscard]] bool moves() const { return moves_; }
  /// x_W of the unit's origin, lead included, `time_s` after its start.
  [[nodiscard]] double at(const OpReader& reader, double time_s) const {
    if (job_.feed_by_controller || !moves_)
      return job_.web_start_x_mm + reader.feedSteps() * machine_.feed_step_mm - unit_ * job_.pitch_mm +
             lead_mm_;
    const double seen_mm = machine_.print_mark_sensor_x_mm - job_.eye_mark_x_mm;
    return seen_mm + reader.markOffset() * machine_.encoder_count_mm + job_.belt_speed_mm_s * time_s +
           lead_mm_;
  }

 private:
  const MachineParameters& machine_;
  const JobParameters& job_;
  int unit_;
  bool moves_{};
  double lead_mm_{};
};

}  // namespace

UnitMotion unitMotion(const Program& program, int unit, const Solution& solution,
                      const MachineParameters& machine, const JobParameters& job, const Axes& axes) {
  const OpRange range = program.units.at(static_cast<std::size_t>(unit));
  OpReader reader(axes.firstAxis());
  for (std::size_t i = 0; i < range.begin; ++i) reader.take(program.ops[i]);
  const SheetPlace sheet(machine, job, unit);
  UnitMotion motion;
  motion.period_s = axes.periodS();
  motion.catch_up = solution.layoutOf(unit).catch_up_periods;
  motion.belt_mm_s = sheet.moves() ? job.belt_speed_mm_s : 0.0;
  motion.x_ref_mm = sheet.at(reader, 0.0);
  Vector2d near_mm = axes.wakesAt();
  const auto place = [&](UnitPeriod& period, double time_s) {
    period.steps = reader.steps();
    near_mm = axes.exactPlaceAt(period.steps.cast<double>(), near_mm);
    period.p_W_mm = near_mm;
    period.p_S_mm = near_mm - Vector2d(sheet.at(reader, time_s), 0.0);
  };
  place(motion.start, 0.0);
  motion.periods = plannedPeriods(solution.pathOf(unit), solution.layoutOf(unit));
  motion.start.planned_S_mm = solution.pathOf(unit).start_S_mm +
                              Vector2d(0.5 * motion.belt_mm_s * motion.catch_up * motion.period_s, 0.0);
  motion.start.line = motion.periods.front().line;
  std::size_t k = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const std::optional<std::uint8_t> power = reader.take(program.ops[i]);
    if (!reader.isPeriod()) continue;
    UnitPeriod& period = motion.periods.at(k++);
    period.power = power;
    place(period, static_cast<double>(k) * motion.period_s);
  }
  motion.periods.resize(k);
  return motion;
}

}  // namespace kerfbench::planner
