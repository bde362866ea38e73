// SPDX-License-Identifier: Apache-2.0
#include "hil/run/dialogs.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/link.h"
#include "hil/base/file_content.h"
#include "hil/source/line_ok.h"

namespace kerfbench::run {
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
  std::optional<std::string> text = base::fileContent(path);
  if (!text) throw std::system_error(errno, std::generic_category(), "cannot read " + path.string());
  return *std::move(text);
}

// Steps of one axis in an operation.
int stepsIn(const std::vector<std::uint8_t>& op, int axis) {
  const unsigned bit = 1U << static_cast<unsigned>(axis);
  if ((op[0] & KB_OP_MOVE) == 0 || (op[0] & bit) == 0) return 0;
  const int before = std::popcount(op[0] & (bit - 1U));
  return static_cast<std::int8_t>(op[1 + static_cast<std::size_t>(before)]);
}

// Cuts the program off behind a lit move across the belt, so that its last steps tell where it ends.
void starve(planner::Program& program, double share, int axis, PreparedJob& job) {
  constexpr int kManySteps = 4;
  const auto from = static_cast<std::size_t>(share * static_cast<double>(program.ops.size()));
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    const int steps = std::abs(stepsIn(program.ops[i], axis));
    job.starved_pulses += steps;
    if (i < from || steps < kManySteps || (program.ops[i][0] & KB_OP_POWER) == 0) continue;
    program.ops.resize(i + 1);
    return;
  }
  throw planner::PlanError("provoke.host_starves_after_share: no lit move across the belt after it");
}

}  // namespace

PreparedJob prepareJob(const scenario::Case& test_case) {
  PreparedJob job;
  if (test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kNone) {
    job.summary = "the job is started at the machine";
    return job;
  }
  if (test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kLineOk) {
    job.gcode = textOf(test_case.scenario.firmware.gcode);
    job.summary =
        fmt::format("G-code of {}, line by line", test_case.scenario.firmware.gcode.filename().string());
    job.dialog = std::make_unique<TalkerDialog<source::LineOkSender>>(source::LineOkSender(job.gcode));
    return job;
  }
  const std::filesystem::path& edited = test_case.scenario.job_gcode;
  planner::MachineParameters machine = scenario::plannerMachine(test_case);
  // One that does not say what it is gets a job for the AVR release; what it answers must agree with that.
  const std::filesystem::path& image = test_case.scenario.firmware.image;
  if (!image.empty()) machine.target = planner::findTarget(image).value_or(planner::Target{});
  const planner::JobParameters parameters = scenario::plannerJob(test_case);
  const planner::PlannerFaults& faults = test_case.scenario.planner_faults;
  planner::Plan plan = edited.empty() ? planner::plan(*test_case.dieline, machine, parameters, faults)
                                      : planner::planFromGcode(textOf(edited), machine, parameters, faults);
  job.summary = fmt::format(
      "{} unit{}, {:.0f} mm of marks and {:.0f} mm of jumps in {:.2f} s each; belt {} mm/s, at most {:.1f}",
      test_case.scenario.print.units, test_case.scenario.print.units == 1 ? "" : "s", plan.cut_length_mm,
      plan.jump_length_mm, plan.unit_time_s, test_case.scenario.belt_speed_mm_s, plan.max_belt_speed_mm_s);
  job.controller = planner::describe(machine.target);
  job.gcode = std::move(plan.gcode);
  job.target = machine.target;
  job.belt_stop_mm_s = plan.belt_stop_mm_s;
  const scenario::ProvokeChoice& provoke = test_case.scenario.provoke;
  if (provoke.cause == scenario::ProvokeChoice::Cause::kHostStarves) {
    const bool gantry = machine.head == planner::MachineParameters::Head::kGantry;
    job.starved_pul = gantry ? Signal::kGantryYPul : Signal::kGalvoYPul;
    starve(plan.program, provoke.share, gantry ? KB_GANTRY_Y : KB_GALVO_Y, job);
  }
  job.dialog = std::make_unique<TalkerDialog<planner::Link>>(planner::Link(std::move(plan.program)));
  return job;
}

}  // namespace kerfbench::run
