// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_own_job.h"
#include "hil/base/terminal.h"

#include <map>

namespace kerfbench::planner {

void addOwnJobOptions(CLI::App& app, OwnJobOptions& options) {
  Mcs51Controller& c = options.controller;
  const std::string group = "Controller that holds its job (--target mcs51)";
  const std::map<std::string, OwnJobOptions::Target> targets{{"uart", OwnJobOptions::Target::kUart},
                                                             {"mcs51", OwnJobOptions::Target::kMcs51}};
  app.add_option("--target", options.target,
                 "uart: operations for the reference controller; mcs51: a control program in C for an 8051, "
                 "which holds the whole job")
      ->transform(CLI::CheckedTransformer(targets, CLI::ignore_case))
      ->default_str("uart")
      ->group(group);
  const auto option = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  option("--mcu", c.mcu, "Part: at89s52, stc15f2k60s2, …");
  option("--clock", c.clock_hz, "Of its oscillator, Hz");
  option("--tick", options.tick_us,
         "Between two steps, at least, us; 0: the shortest that the program makes");
  option("--gate-pin", c.gate_pin, "Laser gate");
  option("--pwm-pin", c.pwm_pin, "Laser power");
  option("--gate-low", c.gate_low, "Whether the laser may emit while its gate is low");
  option("--pwm-low", c.pwm_low, "Whether the power is the share of low");
  option("--start-pin", c.start_pin, "Start button, high while pressed");
  option("--mark-pin", c.mark_pin, "Print mark, high while it is seen");
  option("--guard-pin", c.guard_pin, "Guard, high while closed");
}

std::string ownJobSource(const OwnJobOptions& options, const std::string& input, const std::string& gcode,
                         const MachineParameters& machine, const JobParameters& job) {
  Mcs51Controller controller = options.controller;
  controller.tick_s = options.tick_us / kMicrosecondsPerSecond;
  const OwnJob made = makeOwnJob(input.substr(input.find_last_of('/') + 1), gcode, machine, job, controller);
  base::toTerminal(stderr, made.summary);
  return made.source;
}

}  // namespace kerfbench::planner
