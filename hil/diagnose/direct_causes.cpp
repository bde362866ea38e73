// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/direct_causes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/diagnose/known_causes.h"
#include "hil/diagnose/lost_steps.h"

namespace kerfbench::diagnose {
namespace {

/// A gate is late from here on; the way that pulses lead the beam tells it to 0.05 ms.
constexpr double kGateWorth_s = 2.5e-4;
constexpr std::size_t kFewestGates = 3;
/// Power that differs by less is none of a scale.
constexpr double kPowerWorth = 0.04;
constexpr double kMissing = 0.05;
constexpr double kTwice = 1.7;
/// Share of the path's limit from which on a compensation is wrong.
constexpr double kKerfWorth = 0.4;
/// Share of the sheet's travel below which a release does not follow it, and what that share is known to.
constexpr double kIgnored = 0.3;
constexpr double kFollowedU = 0.04;

Cause direct(std::string key, Size size, std::string sentence) {
  Cause cause;
  cause.key = std::move(key);
  cause.size = std::move(size);
  cause.direct = true;
  cause.sentence = std::move(sentence);
  return cause;
}

/// Median and U of its mean, by the median of the deviations (Rousseeuw and Croux 1993).
struct Middle {
  double value{};
  double U{};
  std::size_t count{};
};

Middle middleOf(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  Middle middle;
  middle.count = values.size();
  if (values.empty()) return middle;
  const auto median = [](std::vector<double>& v) {
    const auto half = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
    std::ranges::nth_element(v, half);
    return *half;
  };
  middle.value = median(values);
  for (double& v : values) v = std::abs(v - middle.value);
  constexpr double kNormal = 1.4826;
  middle.U = 2.0 * 1.25 * kNormal * median(values) / std::sqrt(static_cast<double>(middle.count));
  return middle;
}

void ofDrives(const Evidence& evidence, std::vector<Cause>& causes) {
  for (const DriveReading& drive : evidence.drives) {
    if (drive.setup_violations + drive.hold_violations > 0) {
      const bool setup = drive.setup_violations >= drive.hold_violations;
      causes.push_back(direct(
          "dir_timing", {1e6 * (setup ? drive.least_setup_s : drive.least_hold_s), 0.1, "us"},
          fmt::format("DIR of {} changes too near to PUL {} times: {:.1f} us {} it where the drive asks for "
                      "{:.1f} us; steps "
                      "get lost or go the wrong way at reversals, first at {:.4f} s; move DIR away from PUL "
                      "in the pulse interrupt.",
                      drive.axis, drive.setup_violations + drive.hold_violations,
                      1e6 * (setup ? drive.least_setup_s : drive.least_hold_s), setup ? "before" : "behind",
                      1e6 * (setup ? drive.setup_s : drive.hold_s), drive.first_violation_s)));
    }
    if (drive.width_violations + drive.space_violations > 0)
      causes.push_back(direct(
          "pulse_width",
          {static_cast<double>(drive.width_violations + drive.space_violations), 0.0, "pulses"},
          fmt::format("{} pulses of {} or pauses between them are shorter than the drive asks for, first at "
                      "{:.4f} s: it may miss steps.",
                      drive.width_violations + drive.space_violations, drive.axis, drive.first_violation_s)));
    if (!drive.told || !drive.seen || *drive.told == *drive.seen) continue;
    // Whether pulses were lost or doubled is told by the way that the axis went then: see lost_steps.h.
    const auto gone = static_cast<double>(*drive.told - *drive.seen);
    causes.push_back(
        direct(kPulsesLost, {std::abs(gone), 0.0, "steps"},
               fmt::format("The controller counts {} steps of {} and its pins show {}: {} pulses are lost or "
                           "come twice between its counter "
                           "and its pins; look at what shares the port or the interrupt.",
                           *drive.told, drive.axis, *drive.seen, std::abs(*drive.told - *drive.seen))));
  }
}

void ofGates(const Evidence& evidence, std::vector<Cause>& causes) {
  std::vector<double> open, energy;
  for (const GateReading& gate : evidence.gates) {
    open.push_back(gate.open_late_s);
    energy.push_back(gate.energy_share);
  }
  constexpr double kLeastU_ms = 0.06;
  const Middle opens = middleOf(open);
  if (opens.count >= kFewestGates && std::abs(opens.value) > std::max(kGateWorth_s, 2.0 * opens.U)) {
    const bool late = opens.value > 0.0;
    const double ms = 1e3 * std::abs(opens.value);
    const double U_ms = std::max(kLeastU_ms, 1e3 * opens.U);
    causes.push_back(direct(
        late ? "gate_late" : "gate_early", {ms, U_ms, "ms"},
        fmt::format("The laser's gate opens {} ms {}, behind the pulses and the delay of the axes; {}.",
                    withU(ms, U_ms), late ? "late" : "early",
                    late ? "begins of lines stay uncut" : "begins of lines are burnt while the beam rests")));
  }
  // Where the sheet is not followed the way on it is not the ordered one.
  if (evidence.belt_followed < kIgnored) return;
  if (evidence.power_swing) {
    const PowerSwing& swing = *evidence.power_swing;
    causes.push_back(direct(
        "power_loop_rings", {100.0 * swing.share, 100.0 * swing.share_U, "%"},
        fmt::format(
            "The laser's power swings by ± {} % in a period of {:.1f} ms while the beam keeps its speed: the "
            "loop on the measured power rings; its gain is too high for the delay of its meter.",
            withU(100.0 * swing.share, 100.0 * swing.share_U), 1e3 * swing.period_s)));
  }
  const Middle power = middleOf(energy);
  constexpr double kDark = 0.05;
  if (power.count >= kFewestGates && power.value < kDark) {
    causes.insert(
        causes.begin(),
        direct("gate_inverted", {},
               "No light falls while the gate is open: check the polarity of gate and PWM (`laser.gate_low`, "
               "`laser.pwm_low`)."));
    return;
  }
  if (power.count >= kFewestGates && std::abs(power.value - 1.0) > std::max(kPowerWorth, power.U)) {
    const double U = std::max(1.0, 100.0 * power.U);
    causes.push_back(direct(
        "power_scale", {100.0 * (power.value - 1.0), U, "%"},
        fmt::format(
            "The pins ask for {} % of the energy per length that was ordered: check the scale of the PWM and "
            "the laser's full power.",
            withU(100.0 * power.value, U))));
  }
}

/// No camera sees the beam where its pulses lead it: it is elsewhere, or there is none.
void ofBeam(const Evidence& evidence, std::vector<Cause>& causes) {
  constexpr double kMost = 0.5;
  const bool is_stepper = evidence.machine.full_step_pulses.maxCoeff() > 0.0;
  const bool all_there = std::ranges::all_of(
      evidence.drives, [](const DriveReading& drive) { return !drive.told || drive.told == drive.seen; });
  if (evidence.beam_unseen < kMost || !all_there || !causes.empty()) return;
  const double percent = 100.0 * evidence.beam_unseen;
  if (!evidence.burnt_elsewhere) {
    causes.push_back(
        direct(kBeamUnseen, {},
               fmt::format(
                   "In {:.0f} % of the frames with the gate open no spot is seen, and nothing is burnt where "
                   "the cameras "
                   "look: the laser gives no light (shutter, interlock, supply), or the beam is elsewhere{}.",
                   percent, is_stepper ? " because a stepper was pulled out" : "")));
  } else if (is_stepper) {
    causes.push_back(direct(
        kPulledOut, {},
        fmt::format(
            "The beam is not where its pulses lead it, in {:.0f} % of the frames nowhere about there, and "
            "all pulses are there: a stepper was pulled out; ask for less acceleration and speed, or "
            "give it more current.",
            percent)));
  }
}

void ofEntities(const Evidence& evidence, std::vector<Cause>& causes) {
  std::set<int> entities;
  std::map<int, int> units, missing, twice;
  std::set<int> not_in_program, twice_in_program;
  // A line that lies so far off that no camera finds it is not missing.
  std::map<std::pair<int, int>, std::pair<int, int>> asked;
  for (const LineReading& line : evidence.lines) {
    auto& [of, all] = asked[{line.unit, line.entity}];
    of += std::isfinite(line.asked_mm) ? 1 : 0;
    ++all;
  }
  for (const EntityReading& e : evidence.entities) {
    ++units[e.entity];
    const auto& [of, all] = asked[{e.unit, e.entity}];
    const bool was_led_there = e.in_program && (2 * of > all || !evidence.gates.empty());
    if (e.coverage < kMissing && e.passes < 0.5 && !was_led_there) ++missing[e.entity];
    if (e.passes > kTwice) ++twice[e.entity];
    if (!e.in_program) not_in_program.insert(e.entity);
    if (e.times_in_program > 1) twice_in_program.insert(e.entity);
  }
  const auto names = [](const std::map<int, int>& of) {
    std::vector<std::string> list;
    for (const auto& [entity, count] : of) list.push_back(fmt::format("E{}", entity));
    return fmt::format("{}", fmt::join(list, ", "));
  };
  const bool whole_sheet = missing.size() == units.size();
  if (!missing.empty() && !whole_sheet) {
    const bool planned =
        std::ranges::all_of(missing, [&](const auto& m) { return not_in_program.contains(m.first); });
    causes.push_back(direct("entity_missing", {static_cast<double>(missing.size()), 0.0, "entities"},
                            fmt::format("{} is not cut: {}.", names(missing),
                                        planned ? "it is not in the program, so the planner left it out"
                                                : "it is in the program, so the release left it out")));
  }
  if (!twice.empty()) {
    const bool planned =
        std::ranges::any_of(twice, [&](const auto& m) { return twice_in_program.contains(m.first); });
    causes.push_back(direct("entity_twice", {static_cast<double>(twice.size()), 0.0, "entities"},
                            fmt::format("{} is cut twice: {}.", names(twice),
                                        planned ? "it is in the program twice"
                                                : "it is in the program once, so the release repeats it")));
  }
}

/// The compensation of the kerf, where the edge of the piece is judged.
void ofKerf(const Evidence& evidence, std::vector<Cause>& causes) {
  if (!evidence.edges_judged || !(evidence.kerf_radius_mm > 0.0)) return;
  // The side on which the program runs beside the line, if it does, gives the sign.
  std::vector<double> beside, away, with;
  for (const LineReading& line : evidence.lines) {
    if (!std::isfinite(line.cut_mm)) continue;
    away.push_back(std::abs(line.cut_mm));
    if (!std::isfinite(line.program_mm)) continue;
    beside.push_back(std::abs(line.program_mm));
    if (std::abs(line.program_mm) > 0.25 * evidence.kerf_radius_mm)
      with.push_back(line.program_mm > 0.0 ? line.cut_mm : -line.cut_mm);
  }
  const Middle off = middleOf(away);
  if (off.count < 8 || off.value < kKerfWorth * evidence.limit_mm) return;
  const Middle program = middleOf(beside);
  constexpr double kLeastU_mm = 0.01;
  const double half = evidence.kerf_radius_mm;
  if (program.count > 0 && program.value < 0.25 * half && std::abs(off.value - half) < 0.5 * half) {
    causes.push_back(direct(
        "kerf_uncompensated", {off.value, std::max(kLeastU_mm, off.U), "mm"},
        fmt::format(
            "The kerf is not compensated: edges lie {} mm off, half of the kerf; give the planner the kerf's "
            "radius.",
            withU(off.value, std::max(kLeastU_mm, off.U)))));
    return;
  }
  const Middle same = middleOf(with);
  if (same.count < 8 || std::abs(same.value) < kKerfWorth * evidence.limit_mm) return;
  const double U = std::max(kLeastU_mm, same.U);
  if (same.value > 0.75 * (program.value + half)) {
    causes.push_back(direct("kerf_wrong_side", {same.value, U, "mm"},
                            fmt::format("The kerf is compensated to the wrong side: edges lie {} mm off, the "
                                        "beam runs where the piece is.",
                                        withU(same.value, U))));
    return;
  }
  causes.push_back(
      direct("kerf_radius", {same.value, U, "mm"},
             fmt::format("The kerf is compensated by {} mm too {}: half of it is {:.3f} mm here.",
                         withU(std::abs(same.value), U), same.value > 0.0 ? "much" : "little", half)));
}

void ofWords(const Evidence& evidence, std::vector<Cause>& causes) {
  const auto add = [&](const char* key, const std::string& sentence) {
    if (!sentence.empty()) causes.push_back(direct(key, {}, sentence));
  };
  constexpr double kLongWay_mm = 100.0;
  if (evidence.sheet_moves && evidence.openings == 0 && evidence.belt_travel_mm > kLongWay_mm &&
      evidence.stop.empty())
    add("encoder_reversed", fmt::format("The release never began to cut though the belt ran {:.0f} mm: it "
                                        "does not see the belt come. Check the encoder's sense "
                                        "(wires A and B), then the print mark's sensor.",
                                        evidence.belt_travel_mm));
  if (evidence.belt_followed < kIgnored)
    causes.push_back(direct(
        "belt_ignored", {100.0 * (1.0 - evidence.belt_followed), 100.0 * kFollowedU, "%"},
        fmt::format(
            "The belt's motion is ignored: between begin and end of cuts the pulses follow {:.0f} % of it.",
            100.0 * evidence.belt_followed)));
  add("gate_inverted", evidence.gate_polarity);
  add("axes", evidence.axes);
  add("power_steady", evidence.steady_power);
  add("loop_soft", evidence.corners);
  if (!evidence.stop.empty()) add("stopped", "The controller stopped by itself: " + evidence.stop + ".");
  if (evidence.encoder_backwards || (evidence.belt && evidence.belt->ratio < 0.0))
    add("encoder_reversed",
        "The encoder counts backwards while the sheet runs forwards: change its wires A and B, or its sense "
        "in the release.");
}

}  // namespace

std::vector<Cause> directCauses(const Evidence& evidence) {
  std::vector<Cause> causes;
  ofWords(evidence, causes);
  ofDrives(evidence, causes);
  ofKerf(evidence, causes);
  // Axes or a gate that are wrong by far cut elsewhere or all the time: what else is amiss follows from that.
  ofBeam(evidence, causes);
  const bool is_elsewhere =
      !causes.empty() && (causes.front().key == kPulledOut || causes.front().key == kBeamUnseen);
  if (evidence.gate_polarity.empty() && evidence.axes.empty() && !is_elsewhere) {
    ofEntities(evidence, causes);
    ofGates(evidence, causes);
  }
  return causes;
}

}  // namespace kerfbench::diagnose
