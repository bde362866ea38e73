// SPDX-License-Identifier: Apache-2.0
#include "hil/run/dialogs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/link.h"
#include "hil/base/input_file.h"
#include "hil/source/line_ok.h"

namespace kerfbench::run {
namespace {

/// Firmware that makes no reports is at rest when its pins have been for so long.
constexpr double kQuiet_s = 1.0;

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
  [[nodiscard]] double quiet_s() const override {
    if constexpr (requires { talker_.mayStillMove(); }) return talker_.mayStillMove() ? kQuiet_s : 0.0;
    return 0.0;
  }
  [[nodiscard]] std::vector<std::string> remarks() const override {
    std::vector<std::string> all;
    if constexpr (requires { talker_.complaintsAtStart(); }) {
      for (const std::string& said : talker_.complaintsAtStart())
        all.push_back(fmt::format("The firmware said \"{}\" before it was sent anything.", said));
    }
    return all;
  }

 private:
  Talker talker_;
};

constexpr std::uint64_t kLargestGcode_bytes = std::uint64_t{64} << 20U;

std::string textOf(const std::filesystem::path& path) {
  return base::inputContent(path, kLargestGcode_bytes);
}

// Steps of one axis in an operation.
int stepsIn(const std::vector<std::uint8_t>& op, int axis) {
  const unsigned bit = 1U << static_cast<unsigned>(axis);
  if ((op[0] & KB_OP_MOVE) == 0 || (op[0] & bit) == 0) return 0;
  const int before = std::popcount(op[0] & (bit - 1U));
  return static_cast<std::int8_t>(op[1 + static_cast<std::size_t>(before)]);
}

// The axis that an operation lets follow the belt.
std::optional<int> followerIn(const std::vector<std::uint8_t>& op) {
  if (op[0] != KB_OP_FOLLOW || op[1] == 0) return std::nullopt;
  return op[1] - 1;
}

// Cuts the program off behind a lit move of this axis, so that its last steps tell where it ends.
void cutOff(planner::Program& program, double share, int axis) {
  constexpr int kManySteps = 4;
  const auto from = static_cast<std::size_t>(share * static_cast<double>(program.ops.size()));
  for (std::size_t i = from; i < program.ops.size(); ++i) {
    if (std::abs(stepsIn(program.ops[i], axis)) < kManySteps || (program.ops[i][0] & KB_OP_POWER) == 0)
      continue;
    program.ops.resize(i + 1);
    return;
  }
  throw planner::PlanError("provoke.host_starves_after_share: no lit move across the belt after it");
}

// Units follow each other as the belt brings them or as the head can take them, whichever is slower.
double expectedTime_s(const scenario::Scenario& scenario, const planner::JobParameters& job,
                      const planner::Plan& plan) {
  const double belt_mm_s = scenario.belt_speed_mm_s;
  const double arrival_s = belt_mm_s > 0.0 ? (plan.x_ref_mm - job.web_start_x_mm) / belt_mm_s : 0.0;
  const double spacing_s = belt_mm_s > 0.0 ? scenario.print.pitch_mm / belt_mm_s : 0.0;
  const int more = std::max(scenario.print.units - 1, 0);
  return std::max(arrival_s, 0.0) + static_cast<double>(more) * std::max(spacing_s, plan.cycle_time_s) +
         plan.unit_time_s;
}

std::vector<AxisPulses> pulsesOf(const planner::Program& program) {
  constexpr std::array<Signal, KB_AXES> kPuls{Signal::kGalvoXPul, Signal::kGalvoYPul, Signal::kGantryXPul,
                                              Signal::kGantryYPul, Signal::kFeedPul};
  std::array<long long, KB_AXES> counts{};
  std::array<bool, KB_AXES> follows{};
  for (const auto& op : program.ops) {
    if (const auto axis = followerIn(op)) follows.at(static_cast<std::size_t>(*axis)) = true;
    for (int axis = 0; axis < KB_AXES; ++axis)
      counts.at(static_cast<std::size_t>(axis)) += std::abs(stepsIn(op, axis));
  }
  std::vector<AxisPulses> pulses;
  for (std::size_t axis = 0; axis < KB_AXES; ++axis)
    if (counts.at(axis) > 0 && !follows.at(axis)) pulses.push_back({kPuls.at(axis), counts.at(axis)});
  return pulses;
}

}  // namespace

PreparedJob prepareJob(const scenario::Case& test_case) {
  PreparedJob job;
  if (test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kNone) {
    const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
    job.summary = firmware.onRealPins() ? "the job is started at the machine"
                  : firmware.start_s ? fmt::format("the controller's own job, started by its button at {} s",
                                                   *firmware.start_s)
                                     : "the controller's own job, which starts by itself";
    return job;
  }
  if (test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kLineOk) {
    job.gcode = textOf(test_case.scenario.firmware.gcode);
    job.summary =
        fmt::format("G-code of {}, line by line", test_case.scenario.firmware.gcode.filename().string());
    source::LineOkOptions options;
    options.setup = test_case.scenario.firmware.setup;
    options.ahead_bytes = test_case.scenario.firmware.ahead_bytes;
    job.dialog =
        std::make_unique<TalkerDialog<source::LineOkSender>>(source::LineOkSender(job.gcode, options));
    return job;
  }
  const std::filesystem::path& edited = test_case.scenario.job_gcode;
  const planner::MachineParameters machine = scenario::targetedMachine(test_case);
  const planner::JobParameters parameters = scenario::plannerJob(test_case);
  const planner::PlannerFaults& faults = test_case.scenario.planner_faults;
  planner::Plan plan = edited.empty() ? planner::plan(*test_case.dieline, machine, parameters, faults)
                                      : planner::planFromGcode(textOf(edited), machine, parameters, faults);
  job.summary = fmt::format(
      "{} unit{}, {:.0f} mm of marks and {:.0f} mm of jumps in {:.2f} s each; belt {} mm/s, at most {:.1f}",
      test_case.scenario.print.units, test_case.scenario.print.units == 1 ? "" : "s", plan.cut_length_mm,
      plan.jump_length_mm, plan.unit_time_s, test_case.scenario.belt_speed_mm_s, plan.max_belt_speed_mm_s);
  job.expected_s = expectedTime_s(test_case.scenario, parameters, plan);
  job.controller = planner::describe(machine.target);
  job.gcode = std::move(plan.gcode);
  job.target = machine.target;
  job.belt_stop_mm_s = plan.belt_stop_mm_s;
  const scenario::ProvokeChoice& provoke = test_case.scenario.provoke;
  if (provoke.cause == scenario::ProvokeChoice::Cause::kHostStarves) {
    const bool gantry = machine.head == planner::MachineParameters::Head::kGantry;
    cutOff(plan.program, provoke.share, gantry ? KB_GANTRY_Y : KB_GALVO_Y);
    job.starved = pulsesOf(plan.program);
  }
  job.dialog = std::make_unique<TalkerDialog<planner::Link>>(planner::Link(std::move(plan.program)));
  return job;
}

std::optional<double> programPeriod_s(const PreparedJob& job) {
  return job.controller.empty() ? std::nullopt : std::optional(job.target.periodS());
}

void tellRemarks(const PreparedJob& job, base::Console& console) {
  if (!job.dialog) return;
  for (const std::string& remark : job.dialog->remarks()) console.say("  " + remark);
}

}  // namespace kerfbench::run
