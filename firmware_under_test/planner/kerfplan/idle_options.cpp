// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/idle_options.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kerfbench::planner {
namespace {

/// An option, whether it has an effect, and else why not.
struct Rule {
  const char* option;
  bool acts;
  const char* reason;
};

std::vector<Rule> headRules(const MachineParameters& machine) {
  using Head = MachineParameters::Head;
  const bool two_mirror = machine.head == Head::kTwoMirror;
  const bool gantry = machine.head == Head::kGantry;
  return {{"--throw", two_mirror, "is of --head two-mirror"},
          {"--mirror-spacing", two_mirror, "is of --head two-mirror"},
          {"--focal-length", machine.head == Head::kFTheta, "is of --head f-theta"},
          {"--mirror-step", !gantry, "is of --head two-mirror and f-theta"},
          {"--mirror-acceleration", !gantry, "is of --head two-mirror and f-theta"},
          {"--full-step-pulses", !gantry, "is of --head two-mirror and f-theta"},
          {"--detent-share", !gantry, "is of --head two-mirror and f-theta"},
          {"--rotor-resonance", !gantry, "is of --head two-mirror and f-theta"},
          {"--rotor-damping", !gantry && machine.steppers.resonance_hz > 0.0, "needs --rotor-resonance"},
          {"--gantry-step", gantry, "is of --head gantry"}};
}

std::vector<Rule> beltRules(const JobParameters& job) {
  const bool moves = job.belt_speed_mm_s != 0.0;
  const bool by_mark = moves && !job.feed_by_controller;
  return {{"--print-mark-sensor", by_mark, "needs a --belt-speed, and not --feed: nothing waits for a mark"},
          {"--eye-mark", by_mark, "needs a --belt-speed, and not --feed: nothing waits for a mark"},
          {"--encoder-count", by_mark, "needs a --belt-speed, and not --feed: nothing follows the encoder"},
          {"--web-start", !by_mark,
           "is where the sheet rests: a moving one starts by its mark (no --belt-speed, or --feed)"},
          {"--feed-step", job.feed_by_controller, "needs --feed"},
          {"--feed-acceleration", job.feed_by_controller, "needs --feed"},
          {"--stop-and-go", job.feed_by_controller, "needs --feed"},
          {"--feed", moves, "needs a --belt-speed"},
          {"--alternate", job.units > 1, "needs --units > 1"}};
}

std::vector<Rule> kerfRules(const JobParameters& job) {
  const bool beside = job.kerf_radius_mm != 0.0;
  return {{"--open-cuts", beside, "needs a --kerf-radius"},
          {"--allow-lost", beside, "needs a --kerf-radius"}};
}

std::vector<Rule> powerRules(const PowerOptions& power, bool scenario_by_depth) {
  const bool by_depth = !power.material.empty() || !power.laser.empty();
  const bool is_by_depth = by_depth || scenario_by_depth;
  return {
      {"--spot-diameter", by_depth, "needs --material, --laser and --depth"},
      {"--library", by_depth, "needs --material or --laser"},
      {"--cut-energy", !is_by_depth, "is not used with a material and a laser, which say what a depth takes"},
      {"--full-power", !is_by_depth, "is not used with a laser, whose curve has its full power"}};
}

std::vector<Rule> drawingRules(const OptionContext& context) {
  const char* const kNoDrawing = "is for drawings: a G-code says itself what is cut, and in which order";
  std::vector<Rule> rules;
  for (const char* option : {"--unit", "--page", "--scale", "--turn", "--shift", "--once", "--layer"})
    rules.push_back(
        {option, !context.by_scenario, "is not used with --scenario, which says how its drawing is read"});
  for (const char* option : {"--order", "--perforation-cut", "--perforation-gap"})
    rules.push_back({option, !context.is_gcode, kNoDrawing});
  rules.push_back({"--half-z", !context.is_gcode || context.power.half_depth_mm != 0.0,
                   "is for drawings, or with --half-depth: a G-code has its own Z"});
  return rules;
}

}  // namespace

void refuseIdleOptions(const CLI::App& command, const OptionContext& context) {
  std::vector<std::string> faults;
  for (const std::vector<Rule>& rules :
       {headRules(context.machine), beltRules(context.job), kerfRules(context.job),
        powerRules(context.power, context.job.power != nullptr), drawingRules(context)}) {
    for (const Rule& rule : rules) {
      const CLI::Option* option = command.get_option_no_throw(rule.option);
      if (option != nullptr && option->count() > 0 && !rule.acts)
        faults.push_back(fmt::format("{} has no effect: it {}", rule.option, rule.reason));
    }
  }
  if (!faults.empty()) throw CLI::ValidationError(fmt::format("{}", fmt::join(faults, "\n")));
}

}  // namespace kerfbench::planner
