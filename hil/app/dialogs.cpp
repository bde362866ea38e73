// SPDX-License-Identifier: Apache-2.0
#include "hil/app/dialogs.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "firmware_under_test/planner/link.h"
#include "hil/source/line_ok.h"

namespace kerfbench::hil {
namespace {

// Both talkers have the same shape; only the names of their states differ.
template <typename Talker>
class TalkerDialog final : public Dialog {
 public:
  explicit TalkerDialog(Talker talker) : talker_(std::move(talker)) {}
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> received, double now_s) override {
    return talker_.step(received, now_s);
  }
  [[nodiscard]] State state() const override {
    if (talker_.state() == Talker::State::kDone) return State::kDone;
    return talker_.state() == Talker::State::kFailed ? State::kFailed : State::kBusy;
  }
  [[nodiscard]] std::string message() const override { return talker_.message(); }

 private:
  Talker talker_;
};

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::system_error(errno, std::generic_category(), "cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

PreparedJob prepareJob(const Case& the_case) {
  PreparedJob job;
  if (the_case.scenario.firmware.dialog == FirmwareChoice::Dialog::kLineOk) {
    job.gcode = textOf(the_case.scenario.firmware.gcode);
    job.summary =
        fmt::format("G-code of {}, line by line", the_case.scenario.firmware.gcode.filename().string());
    job.dialog = std::make_unique<TalkerDialog<LineOkSender>>(LineOkSender(job.gcode));
    return job;
  }
  const std::filesystem::path& edited = the_case.scenario.job_gcode;
  planner::MachineParameters machine = plannerMachine(the_case);
  machine.target = planner::targetOfImage(the_case.scenario.firmware.image);
  const planner::JobParameters parameters = plannerJob(the_case);
  const planner::PlannerFaults& faults = the_case.scenario.planner_faults;
  planner::Plan plan = edited.empty() ? planner::plan(the_case.dieline, machine, parameters, faults)
                                      : planner::planFromGcode(textOf(edited), machine, parameters, faults);
  job.summary = fmt::format(
      "{} unit{}, {:.0f} mm of marks and {:.0f} mm of jumps in {:.2f} s each; belt {} mm/s, at most {:.1f}",
      the_case.scenario.print.units, the_case.scenario.print.units == 1 ? "" : "s", plan.cut_length_mm,
      plan.jump_length_mm, plan.unit_time_s, the_case.scenario.belt_speed_mm_s, plan.max_belt_speed_mm_s);
  job.controller = describe(machine.target);
  job.gcode = std::move(plan.gcode);
  job.dialog = std::make_unique<TalkerDialog<planner::Link>>(planner::Link(std::move(plan.program)));
  return job;
}

}  // namespace kerfbench::hil
