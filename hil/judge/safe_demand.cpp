// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/safe_demand.h"

#include <fmt/format.h>

#include <algorithm>

namespace kerfbench::judge {
namespace {

using Cause = scenario::ProvokeChoice::Cause;

constexpr double kReport_s = 0.05;
constexpr double kFrameBits = 134 * 10;  // a frame may be on the wire when the host falls silent
constexpr double kSilence_s = 0.25;
constexpr double kEncoderCounts = 16;
constexpr double kFast_s = 7e-3;
constexpr double kMarks = 8;             // of which one is lost
constexpr double kFieldNear_mm = 0.5;    // from where on the bench waits for the controller
constexpr double kFieldWaver_mm = 0.5;   // that the controller may grant beyond
constexpr double kFilterPeriods = 12;    // until the tracked speed has settled
constexpr double kBeltSpan_s = 40e-3;    // over which the bench measures the belt's speed
constexpr double kFramePause_s = 20e-3;  // after which a frame is given up

double encoderWindow_s(const scenario::Case& test_case, double period_s) {
  const double counts_per_s =
      test_case.scenario.belt_speed_mm_s / test_case.machine.controller.encoder_count_mm;
  return 2 * std::max(kEncoderCounts / counts_per_s + period_s, 2 * period_s) + 2 * period_s;
}

}  // namespace

inspect::SafeStateDemand safeStateDemand(const scenario::Case& test_case, const run::PreparedJob& job,
                                         const controller::PulseCounter& pins, double line_cut_s) {
  const scenario::ProvokeChoice& provoke = test_case.scenario.provoke;
  const double period_s = job.target.periodS();
  const double frame_s = kFrameBits / job.target.baud;
  const double stand_s = 2 * period_s;  // the period at hand, and one that the main loop may be busy
  inspect::SafeStateDemand demand;
  demand.cause_s = provoke.at_s;
  demand.stop_s = 8 * period_s;  // the period offered, one under way, five of the ramp
  demand.report_s = kReport_s;
  switch (provoke.cause) {
    case Cause::kNone:
      break;
    case Cause::kInterlock:
      demand.cause = "the guard was opened";
      demand.faults = {"interlock"};
      demand.stop_s = stand_s;
      break;
    case Cause::kLimit:
      demand.cause = fmt::format("the limit switch of {} closed", provoke.limit);
      demand.faults = {"limit"};
      demand.stop_s = stand_s;
      break;
    case Cause::kEncoder:
      demand.cause = provoke.encoder_lines == "both"
                         ? "both wires of the encoder broke"
                         : fmt::format("wire {} of the encoder broke", provoke.encoder_lines);
      demand.faults = {"encoder"};
      demand.window_s = encoderWindow_s(test_case, period_s);
      break;
    case Cause::kUartSilent:
      demand.cause = "the host fell silent within a frame";
      demand.faults = {"silent"};
      demand.cause_s = line_cut_s;
      demand.window_s = frame_s + kSilence_s + 2 * period_s;
      break;
    case Cause::kUartNoise:
      demand.cause =
          fmt::format("{:g} % of the host's bytes were damaged from there on", 100 * provoke.share);
      demand.faults = {"uart", "silent"};
      demand.cause_s = line_cut_s;
      demand.window_s = frame_s + kSilence_s + 2 * period_s;
      break;
    case Cause::kHostStarves:
      demand.cause = "the last step came of what the host has sent";
      demand.faults = {"dry"};
      demand.cause_s = pins.pulse_s(job.starved_pul, job.starved_pulses);
      demand.window_s = period_s;
      break;
    case Cause::kMarksFlicker:
      demand.cause = "the print mark sensor began to flicker";
      demand.faults = {"marks"};
      demand.window_s = kMarks * scenario::kFlicker_s + 2 * period_s;
      break;
    case Cause::kFieldLeft: {
      demand.cause = fmt::format("the gantry came within {:g} mm of its field's edge", kFieldNear_mm);
      demand.faults = {"field"};
      const auto& told = test_case.machine.controller;
      const auto inside = [&](double mm) { return static_cast<long long>(mm / told.gantry_step_mm); };
      demand.cause_s = pins.leaves_s(Signal::kGantryXPul, inside(told.field_min_mm[0] + kFieldNear_mm),
                                     inside(told.field_max_mm[0] - kFieldNear_mm));
      demand.window_s = (kFieldNear_mm + kFieldWaver_mm) / test_case.scenario.belt_speed_mm_s + 2 * period_s;
      break;
    }
    case Cause::kBeltTooFast:
      demand.cause = fmt::format("the belt exceeded {:.1f} mm/s", job.belt_stop_mm_s);
      demand.faults = {"belt-fast"};
      demand.cause_s =
          pins.beltFaster_s(job.belt_stop_mm_s / test_case.machine.controller.encoder_count_mm, kBeltSpan_s);
      demand.cause_s -= 0.5 * kBeltSpan_s;  // a mean is that of the middle
      demand.window_s = kFast_s + kFilterPeriods * period_s;
      break;
  }
  if (!provoke.expect.empty()) demand.faults = {provoke.expect};
  if (provoke.expect == "watchdog" || provoke.expect == "late") {
    // A main loop that is stuck or waits over a broken frame: the tick's interrupt finds no period prepared.
    demand.window_s = frame_s + kFramePause_s + 3 * period_s + job.target.tick_s;
    demand.stop_s = stand_s;
  }
  return demand;
}

}  // namespace kerfbench::judge
