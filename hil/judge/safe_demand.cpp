// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/safe_demand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::judge {
namespace {

using Cause = scenario::ProvokeChoice::Cause;

constexpr double kReport_s = 0.05;
constexpr double kFrameBits =
    134 * 10;  // Bits of a frame that may be on the wire when the host falls silent.
constexpr double kSilence_s = 0.25;
constexpr double kEncoderCounts = 16;
constexpr double kFast_s = 7e-3;
constexpr double kMarks = 8;  // Marks of which one is lost.
constexpr double kFieldNear_mm =
    0.5;  // Distance to the edge from which on the bench waits for the controller.
constexpr double kFieldWaver_mm = 0.5;   // Distance beyond the edge that the controller may grant.
constexpr double kFilterPeriods = 12;    // Periods until the tracked speed has settled.
constexpr double kBeltSpan_s = 40e-3;    // Time over which the bench measures the belt's speed.
constexpr double kFramePause_s = 20e-3;  // Pause after which a frame is given up.

double encoderWindow_s(const scenario::Case& test_case, double period_s) {
  const double counts_per_s =
      test_case.scenario.belt_speed_mm_s / test_case.machine.controller.encoder_count_mm;
  return 2 * std::max(kEncoderCounts / counts_per_s + period_s, 2 * period_s) + 2 * period_s;
}

/// Demands that follow from the scenario, the job and what was recorded.
class DemandWriter {
 public:
  DemandWriter(const scenario::Case& test_case, const run::PreparedJob& job,
               const controller::PulseCounter& pins, double line_cut_s)
      : case_(test_case),
        provoke_(test_case.scenario.provoke),
        job_(job),
        pins_(pins),
        line_cut_s_(line_cut_s),
        period_s_(job.target.periodS()),
        frame_s_(kFrameBits / job.target.baud),
        stand_s_(2 * period_s_) {
    demand_.cause_s = provoke_.at_s;
    demand_.stop_s = 8 * period_s_;  // The period offered, one under way, five of the ramp.
    demand_.report_s = kReport_s;
  }

  inspect::SafeStateDemand written() {
    writeSensor();
    writeLine();
    writeBelt();
    writeExpected();
    return demand_;
  }

 private:
  void write(std::string cause, std::vector<std::string> faults) {
    demand_.cause = std::move(cause);
    demand_.faults = std::move(faults);
  }

  void writeSensor() {
    switch (provoke_.cause) {
      case Cause::kInterlock:
        write("the guard was opened", {"interlock"});
        demand_.stop_s = stand_s_;
        break;
      case Cause::kLimit:
        write(fmt::format("the limit switch of {} closed", provoke_.limit), {"limit"});
        demand_.stop_s = stand_s_;
        break;
      case Cause::kEncoder:
        write(provoke_.encoder_lines == "both"
                  ? "both wires of the encoder broke"
                  : fmt::format("wire {} of the encoder broke", provoke_.encoder_lines),
              {"encoder"});
        demand_.window_s = encoderWindow_s(case_, period_s_);
        break;
      case Cause::kMarksFlicker:
        write("the print mark sensor began to flicker", {"marks"});
        demand_.window_s = kMarks * scenario::kFlicker_s + 2 * period_s_;
        break;
      default:
        break;
    }
  }

  void writeLine() {
    switch (provoke_.cause) {
      case Cause::kUartSilent:
        write("the host fell silent within a frame", {"silent"});
        demand_.cause_s = line_cut_s_;
        demand_.window_s = frame_s_ + kSilence_s + 2 * period_s_;
        break;
      case Cause::kUartNoise:
        write(fmt::format("{:g} % of the host's bytes were damaged from there on", 100 * provoke_.share),
              {"uart", "silent"});
        demand_.cause_s = line_cut_s_;
        demand_.window_s = frame_s_ + kSilence_s + 2 * period_s_;
        break;
      case Cause::kHostStarves:
        write("the last step came of what the host has sent", {"dry"});
        demand_.cause_s = lastSent_s();
        demand_.window_s = period_s_;
        break;
      default:
        break;
    }
  }

  /// When the last step of any axis came that the host has sent; NaN if one never came.
  [[nodiscard]] double lastSent_s() const {
    double last_s = job_.starved.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    for (const run::AxisPulses& axis : job_.starved) {
      const double own_s = pins_.pulse_s(axis.pul, axis.count);
      last_s = std::isnan(own_s) || std::isnan(last_s) ? std::numeric_limits<double>::quiet_NaN()
                                                       : std::max(last_s, own_s);
    }
    return last_s;
  }

  void writeBelt() {
    const auto& set_up = case_.machine.controller;
    if (provoke_.cause == Cause::kFieldLeft) {
      write(fmt::format("the gantry came within {:g} mm of its field's edge", kFieldNear_mm), {"field"});
      const auto inside = [&](double mm) { return static_cast<long long>(mm / set_up.gantry_step_mm); };
      demand_.cause_s = pins_.leaves_s(Signal::kGantryXPul, inside(set_up.field_min_mm[0] + kFieldNear_mm),
                                       inside(set_up.field_max_mm[0] - kFieldNear_mm));
      demand_.window_s = (kFieldNear_mm + kFieldWaver_mm) / case_.scenario.belt_speed_mm_s + 2 * period_s_;
    }
    if (provoke_.cause == Cause::kBeltTooFast) {
      write(fmt::format("the belt exceeded {:.1f} mm/s", job_.belt_stop_mm_s), {"belt-fast"});
      demand_.cause_s = pins_.beltFaster_s(job_.belt_stop_mm_s / set_up.encoder_count_mm, kBeltSpan_s);
      demand_.cause_s -= 0.5 * kBeltSpan_s;  // A mean is that of the middle.
      demand_.window_s = kFast_s + kFilterPeriods * period_s_;
    }
  }

  void writeExpected() {
    if (!provoke_.expect.empty()) demand_.faults = {provoke_.expect};
    if (provoke_.expect != "watchdog" && provoke_.expect != "late") return;
    // A main loop that is stuck or waits over a broken frame: the tick's interrupt finds no period prepared.
    demand_.window_s = frame_s_ + kFramePause_s + 3 * period_s_ + job_.target.tick_s;
    demand_.stop_s = stand_s_;
  }

  const scenario::Case& case_;
  const scenario::ProvokeChoice& provoke_;
  const run::PreparedJob& job_;
  const controller::PulseCounter& pins_;
  double line_cut_s_;
  double period_s_;
  double frame_s_;
  double stand_s_;  // The period at hand, and one that the main loop may be busy.
  inspect::SafeStateDemand demand_;
};

}  // namespace

inspect::SafeStateDemand safeStateDemand(const scenario::Case& test_case, const run::PreparedJob& job,
                                         const controller::PulseCounter& pins, double line_cut_s) {
  return DemandWriter(test_case, job, pins, line_cut_s).written();
}

}  // namespace kerfbench::judge
