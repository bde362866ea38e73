// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/own_job/own_job.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "firmware_under_test/planner/head/axes.h"
#include "job_source.h"

namespace kerfbench::planner {
namespace {

/// Ticks from a mark's edge to the load of its unit's first period, less than planned: the edge is seen half
/// a tick late on the mean, and a step that a period asks for comes half a tick after its time.
constexpr int kMarkTicksEarlier = 1;
constexpr int kFewestMarkTicks = 4;
constexpr int kTicksOfPeriod = 32;

/// Ticks by which the laser waits for the mirrors. Steps come half a tick after their time, the gate does
/// not.
int laserTicks(const MachineParameters& machine) {
  const double wait_s = std::max(0.0, machine.tracking_delay_s - machine.laser_lag_s);
  return std::max(0, static_cast<int>(std::lround(wait_s / machine.target.tick_s - 0.5)));
}

std::string tableText(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kInLine = 24;
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    text += fmt::format("{}{},{}", i % kInLine == 0 ? "  " : "", bytes[i],
                        i % kInLine == kInLine - 1 || i + 1 == bytes.size() ? "\n" : "");
  return text;
}

/// Fills in the places $NAME$ of the source.
std::string filled(const std::map<std::string, std::string, std::less<>>& values) {
  std::string text;
  std::string_view rest = kJobSource;
  for (;;) {
    const std::size_t begin = rest.find('$');
    text += rest.substr(0, begin);
    if (begin == std::string_view::npos) return text;
    const std::size_t end = rest.find('$', begin + 1);
    text += values.at(std::string(rest.substr(begin + 1, end - begin - 1)));
    rest.remove_prefix(end + 1);
  }
}

/// A title that no comment of C is ended by.
std::string titleOf(const std::string& text) {
  std::string title;
  for (const char c : text) title += c >= ' ' && c <= '~' && c != '*' && c != '\\' ? c : '_';
  return title;
}

/// Registers of the pins' modes of an STC15, as `format` has them: all 0 makes the pins bidirectional, some
/// of which only listen after a reset.
std::string portModes(fmt::format_string<const int&, const int&> format) {
  std::string text;
  for (const int address : {0x93, 0x94, 0x91, 0x92, 0x95, 0x96, 0xB1, 0xB2})
    text += fmt::format(format, address, address);
  return text;
}

std::string byteOf(int value, int number) {
  return std::to_string(static_cast<unsigned>(value) >> (8U * static_cast<unsigned>(number)) & 0xFFU);
}

void addPins(std::map<std::string, std::string, std::less<>>& values, const Mcs51Controller& c) {
  const auto pin = [&](const std::string& name, const std::string& text) {
    values[name + "_PIN"] = pinFrom(text).name();
    values[name + "_BIT"] = fmt::format("0x{:02x}", pinFrom(text).address());
  };
  pin("GATE", c.gate_pin);
  pin("PWM", c.pwm_pin);
  pin("START", c.start_pin);
  pin("MARK", c.mark_pin);
  pin("GUARD", c.guard_pin);
  const auto laser = [&](const std::string& name, const std::string& text, bool low) {
    const Mcs51Pin at = pinFrom(text);
    values[name + "_OFF"] = fmt::format("P{}_{} = {}", at.port, at.bit, low ? 1 : 0);
    values[name + "_OFF_ASM"] = (low ? "setb " : "clr  ") + name;
    values[name + "_INVERT"] = low ? "    cpl  c\n" : "";
  };
  laser("GATE", c.gate_pin, c.gate_low);
  laser("PWM", c.pwm_pin, c.pwm_low);
}

std::string sourceOf(const std::string& title, const OwnJob& made, const MachineParameters& machine,
                     const JobParameters& job, const Mcs51Controller& controller) {
  const Mcs51Account& account = made.account;
  const int mark_ticks = std::max(0, made.table.mark_ticks - kMarkTicksEarlier);
  std::map<std::string, std::string, std::less<>> values{
      {"TITLE", titleOf(title)},
      {"CODE_BYTES", std::to_string(account.code_bytes)},
      {"PART", controller.mcu},
      {"CLOCK_HZ", fmt::format("{:.0f}", controller.clock_hz)},
      {"BELT_MM_S", fmt::format("{:g}", job.belt_speed_mm_s)},
      {"MARK_TICKS", std::to_string(made.table.mark_ticks)},
      {"TICK_US", fmt::format("{:g}", account.target.tick_s * kMicrosecondsPerSecond)},
      {"TICK_CLOCKS", std::to_string(account.timer_counts * 12)},
      {"WORST_CLOCKS", std::to_string(account.tick_clocks)},
      {"TABLE", tableText(made.table.bytes)},
      {"PORT_SFRS", account.has_port_modes ? portModes("__sfr __at(0x{:02x}) mode_{:02x};\n") : ""},
      {"PORT_MODES", account.has_port_modes ? portModes("  mode_{0:02x} = 0;\n") : ""},
      {"UNITS_LOW", byteOf(made.table.units, 0)},
      {"UNITS_HIGH", byteOf(made.table.units, 1)},
      {"RELOAD", std::to_string((256 - account.timer_counts) & 0xFF)},
      {"LASER_TICKS_LEFT", std::to_string(kTicksOfPeriod - laserTicks(machine))},
      {"LOOP", std::to_string(made.table.loop)},
      {"FINAL", std::to_string(made.table.final)}};
  for (int i = 0; i < 3; ++i) values["MARK_" + std::to_string(i)] = byteOf(mark_ticks, i);
  addPins(values, controller);
  return filled(values);
}

/// Plans for the controller; the belt's travel in a tick is what stands for an encoder's count.
OwnJob planned(const std::string& gcode, MachineParameters& machine, const JobParameters& job,
               const Mcs51Account& account) {
  OwnJob made;
  made.account = account;
  machine.target = account.target;
  if (job.belt_speed_mm_s > 0.0) machine.encoder_count_mm = job.belt_speed_mm_s * account.target.tick_s;
  made.plan = planFromGcode(gcode, machine, job);
  made.table = tableOf(made.plan.program, Axes(machine, {}).firstAxis());
  return made;
}

std::size_t bytesOf(const OwnJob& made) { return made.account.program_bytes + made.table.bytes.size(); }

/// First of some higher mark speeds at which the job fits the memory.
std::optional<double> fittingMarkSpeed(const std::string& gcode, MachineParameters machine, JobParameters job,
                                       const Mcs51Account& account) {
  const double given = job.mark_speed_mm_s;
  for (const double share : {1.1, 1.25, 1.5, 2.0, 3.0, 5.0}) {
    job.mark_speed_mm_s = given * share;
    try {
      if (bytesOf(planned(gcode, machine, job, account)) <= account.code_bytes) return job.mark_speed_mm_s;
    } catch (const PlanError&) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

/// Shortest of some longer ticks, in us, with which the job fits the memory.
std::optional<double> fittingTick_us(const std::string& gcode, MachineParameters machine,
                                     const JobParameters& job, Mcs51Controller controller) {
  const int first = accountOf(controller).timer_counts;
  for (int counts = first + 8; counts <= 256; counts += 8) {
    controller.tick_s = counts * 12 / controller.clock_hz;
    try {
      const Mcs51Account account = accountOf(controller);
      if (bytesOf(planned(gcode, machine, job, account)) <= account.code_bytes)
        return account.target.tick_s * kMicrosecondsPerSecond;
    } catch (const PlanError&) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

[[noreturn]] void refuseSize(const OwnJob& made, const std::string& gcode, const MachineParameters& machine,
                             const JobParameters& job, const Mcs51Controller& controller) {
  const Mcs51Account& account = made.account;
  std::string what = fmt::format(
      "the job needs {} bytes of code memory, {} of them for its {} periods; {} has {}\n"
      "it would fit: a part with that much ({})",
      bytesOf(made), made.table.bytes.size(), made.table.periods, controller.mcu, account.code_bytes,
      partsWith(bytesOf(made)));
  if (const auto speed = fittingMarkSpeed(gcode, machine, job, account))
    what += fmt::format(", --mark-speed {:g}", *speed);
  if (const auto tick_us = fittingTick_us(gcode, machine, job, controller))
    what += fmt::format(", --tick {:g}", *tick_us);
  throw PlanError(what);
}

void refuseUnfit(const MachineParameters& machine, const JobParameters& job) {
  if (job.feed_by_controller || job.stop_and_go)
    throw PlanError("--feed: a program that holds its job drives no feed; the belt runs by itself");
  if (job.power_loop) throw PlanError("a program that holds its job reads no power meter");
  const int ticks = laserTicks(machine);
  if (ticks >= kTicksOfPeriod)
    throw PlanError(fmt::format("the laser would wait {} ticks for the mirrors; {} can be waited", ticks,
                                kTicksOfPeriod - 1));
}

}  // namespace

OwnJob makeOwnJob(const std::string& title, const std::string& gcode, MachineParameters machine,
                  JobParameters job, const Mcs51Controller& controller) {
  const Mcs51Account account = accountOf(controller);
  machine.target = account.target;
  job.belt_by_clock = true;
  refuseUnfit(machine, job);
  OwnJob made = planned(gcode, machine, job, account);
  if (bytesOf(made) > account.code_bytes) refuseSize(made, gcode, machine, job, controller);
  if (job.belt_speed_mm_s > 0.0 && made.table.mark_ticks < kFewestMarkTicks)
    throw PlanError(
        fmt::format("a unit would begin {} ticks after its print mark, and {} is the least: move "
                    "the sensor upstream (--print-mark-sensor)",
                    made.table.mark_ticks, kFewestMarkTicks));
  made.source = sourceOf(title, made, machine, job, controller);
  made.summary = fmt::format(
      "{} at {:g} MHz\n"
      "  code memory     {} of {} bytes, {} of them for {} periods\n"
      "  tick            {:g} us, {} clocks, of which the longest takes {}\n"
      "  steps           {:.0f} in a second of an axis, at most\n"
      "  belt            {:g} mm/s by its own clock, at most {:.2f} mm/s\n",
      controller.mcu, controller.clock_hz * 1e-6, bytesOf(made), account.code_bytes, made.table.bytes.size(),
      made.table.periods, account.target.tick_s * kMicrosecondsPerSecond, account.timer_counts * 12,
      account.tick_clocks, account.target.max_steps / account.target.periodS(), job.belt_speed_mm_s,
      made.plan.max_belt_speed_mm_s);
  return made;
}

}  // namespace kerfbench::planner
