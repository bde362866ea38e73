// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/own_job/job_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::planner {
namespace {

using Periods = std::vector<TablePeriod>;
using Op = std::vector<std::uint8_t>;

constexpr std::size_t kMostRuns = 255;
constexpr int kMostUnits = 65535;

/// Program cut at its print marks: the way to the first unit, then each unit with the way to the next.
struct Legs {
  std::vector<Periods> legs{1};
  std::vector<int> offsets;  ///< Ticks from each mark to its unit.
};

TablePeriod periodOf(const Op& op, int first_axis) {
  TablePeriod period;
  std::size_t next = 1;
  for (int axis = 0; axis < KB_AXES; ++axis) {
    if ((op[0] >> static_cast<unsigned>(axis) & 1U) == 0) continue;
    const int steps = static_cast<std::int8_t>(op[next++]);
    if (axis == KB_FEED)
      throw PlanError("a program that holds its job makes no feed steps: leave --feed out");
    (axis == first_axis ? period.x_steps : period.y_steps) = steps;
  }
  constexpr double kDutyOfByte = 256.0 / 255.0;
  if ((op[0] & KB_OP_POWER) != 0)
    period.power = std::min(255, static_cast<int>(std::lround(op[next] * kDutyOfByte)));
  return period;
}

int offsetOf(const Op& op) {
  std::uint32_t offset = 0;
  for (std::size_t i = 0; i < 4; ++i) offset |= static_cast<std::uint32_t>(op[1 + i]) << (8 * i);
  return static_cast<std::int32_t>(offset);
}

Legs legsOf(const Program& program, int first_axis) {
  Legs result;
  for (const Op& op : program.ops) {
    if ((op[0] & KB_OP_MOVE) != 0) {
      result.legs.back().push_back(periodOf(op, first_axis));
    } else if (op[0] == KB_OP_WAIT_MARK) {
      result.offsets.push_back(offsetOf(op));
      result.legs.emplace_back();
    } else if (op[0] != KB_OP_END) {
      throw PlanError("a program that holds its job follows no encoder");
    }
  }
  // The laser's delay ends within a period at rest, before the controller waits.
  for (Periods& leg : result.legs) leg.push_back({});
  return result;
}

/// Level of DIR for the steps, or that before where there are none.
int dirFor(int steps, int before) { return steps == 0 ? before : (steps < 0 ? 1 : 0); }

/// Level of DIR for the first steps of an axis, so that it changes at rest before them.
template <typename StepsOf>
int firstDir(std::span<const TablePeriod> periods, const StepsOf& stepsOf) {
  const auto first = std::ranges::find_if(periods, [&](const TablePeriod& p) { return stepsOf(p) != 0; });
  return first == periods.end() ? 1 : dirFor(stepsOf(*first), 1);
}

/// Writes runs of periods.
class Writer {
 public:
  /// Begins where the table is entered from more than one place.
  void enter(std::span<const TablePeriod> what_follows) {
    dir_x_ = firstDir(what_follows, [](const TablePeriod& p) { return p.x_steps; });
    dir_y_ = firstDir(what_follows, [](const TablePeriod& p) { return p.y_steps; });
    power_.reset();
  }
  void command(TableCommand command) {
    constexpr std::uint8_t kIsCommand = 4;
    table.bytes.insert(table.bytes.end(), {static_cast<std::uint8_t>(command), kIsCommand});
  }
  void write(std::span<const TablePeriod> periods) {
    for (std::size_t i = 0; i < periods.size();) {
      std::size_t runs = 1;
      while (runs < kMostRuns && i + runs < periods.size() && periods[i + runs] == periods[i]) ++runs;
      writeRun(periods[i], runs);
      i += runs;
    }
    table.periods += periods.size();
  }

  JobTable table;

 private:
  void writeRun(const TablePeriod& period, std::size_t runs) {
    dir_x_ = dirFor(period.x_steps, dir_x_);
    dir_y_ = dirFor(period.y_steps, dir_y_);
    const bool lit = period.power >= 0;
    const bool has_power = lit && power_ != period.power;
    const bool repeats = runs > 1;
    put(std::abs(period.x_steps) * 8 + dir_x_ + (lit ? 2 : 0) + (has_power ? 4 : 0));
    put(std::abs(period.y_steps) * 8 + dir_y_ + (repeats ? 2 : 0));
    if (has_power) put(period.power);
    if (lit) power_ = period.power;
    if (repeats) put(static_cast<int>(runs));
  }
  void put(int byte) { table.bytes.push_back(static_cast<std::uint8_t>(byte)); }

  int dir_x_{1}, dir_y_{1};  // Levels after a reset.
  std::optional<int> power_;
};

void requireSameOffset(const std::vector<int>& offsets) {
  if (std::ranges::all_of(offsets, [&](int offset) { return offset == offsets.front(); })) return;
  throw PlanError(
      "a program that holds its job begins all units at the same distance from their marks: leave "
      "--alternate out");
}

/// The units are alike, the last one but for its way back.
bool areAlike(const std::vector<Periods>& legs) {
  return legs.size() > 2 &&
         std::all_of(legs.begin() + 1, legs.end() - 1, [&](const Periods& leg) { return leg == legs[1]; });
}

void writeLoop(Writer& writer, const std::vector<Periods>& legs) {
  const Periods& unit = legs[1];
  const Periods& last = legs.back();
  const auto same = static_cast<std::size_t>(std::ranges::mismatch(unit, last).in1 - unit.begin());
  const std::span<const TablePeriod> all(unit);
  writer.table.units = static_cast<int>(legs.size()) - 1;
  writer.table.loop = writer.table.bytes.size();
  writer.enter(unit);
  writer.command(TableCommand::kWaitMark);
  writer.write(all.first(same));
  writer.command(TableCommand::kUnitDone);
  writer.write(all.subspan(same));
  writer.command(TableCommand::kNextUnit);
  writer.table.final = writer.table.bytes.size();
  const std::span<const TablePeriod> end = std::span(last).subspan(same);
  writer.enter(end);
  writer.write(end);
}

}  // namespace

JobTable tableOf(const Program& program, int first_axis) {
  const Legs all = legsOf(program, first_axis);
  if (all.offsets.size() > kMostUnits)
    throw PlanError(
        fmt::format("{} units; a program that holds its job counts to {}", all.offsets.size(), kMostUnits));
  requireSameOffset(all.offsets);
  Writer writer;
  writer.table.mark_ticks = all.offsets.empty() ? 0 : all.offsets.front();
  writer.table.units = 1;
  writer.enter(all.legs.front());
  writer.write(all.legs.front());
  if (areAlike(all.legs)) {
    writeLoop(writer, all.legs);
  } else {
    for (std::size_t i = 1; i < all.legs.size(); ++i) {
      writer.command(TableCommand::kWaitMark);
      writer.write(all.legs[i]);
    }
  }
  writer.command(TableCommand::kEnd);
  return std::move(writer.table);
}

}  // namespace kerfbench::planner
