// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/known_causes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kerfbench::diagnose {
namespace {

using Sizes = std::vector<double>;
using Say = std::function<std::string(const Sizes&, double)>;
using Advise = std::function<std::string(const Sizes&)>;

constexpr double kPercent = 100.0;
constexpr double kMilli = 1e3;

/// "… too large" or "… too small".
Say scaleSaid(const char* what) {
  return [what](const Sizes& s, double U) {
    return fmt::format("{} {} % too {}", what, withU(std::abs(s[0]), U), s[0] > 0.0 ? "large" : "small");
  };
}

Say shiftSaid(const char* what, const char* axis) {
  return [what, axis](const Sizes& s, double U) {
    return fmt::format("{} {} mm off along {}{}", what, withU(std::abs(s[0]), U), s[0] > 0.0 ? "+" : "-",
                       axis);
  };
}

Say vectorSaid(const char* what) {
  return [what](const Sizes& s, double U) {
    return fmt::format("{} {} mm off ({:+.3f} along x, {:+.3f} along y)", what,
                       withU(std::hypot(s[0], s[1]), U), s[0], s[1]);
  };
}

Say angleSaid(const char* what) {
  return [what](const Sizes& s, double U) {
    return fmt::format("{} {} mrad {}", what, withU(std::abs(s[0]), U),
                       s[0] > 0.0 ? "counter-clockwise" : "clockwise");
  };
}

Advise advice(const char* text) {
  return [text](const Sizes&) { return std::string(text); };
}

KnownCause linear(const std::string& key, const std::string& signature, double factor,
                  const std::string& unit, Say what, Advise then) {
  return {key, {key, {signature}}, {signature}, factor, unit, std::move(what), std::move(then)};
}

void ofProgram(std::vector<KnownCause>& list) {
  const char* const kPlanner =
      "the program is already wrong: check the planner or the G-code that was sent, not the firmware";
  list.push_back({"program_offset",
                  {"program_offset", {"program_x", "program_y"}},
                  {"program_x", "program_y"},
                  1.0,
                  "mm",
                  vectorSaid("The program lies"),
                  advice(kPlanner)});
  list.push_back(linear("program_rotation", "program_rotation", kMilli, "mrad",
                        angleSaid("The program is turned by"), advice(kPlanner)));
  list.push_back(
      linear("program_scale", "program_scale", kPercent, "%", scaleSaid("The program is"), advice(kPlanner)));
  list.push_back(linear("program_scale_x", "program_scale_x", kPercent, "%",
                        scaleSaid("Along x the program is"), advice(kPlanner)));
  list.push_back(linear("program_scale_y", "program_scale_y", kPercent, "%",
                        scaleSaid("Along y the program is"), advice(kPlanner)));
  list.push_back(linear(
      "program_shear", "program_shear", kMilli, "mrad",
      [](const Sizes& s, double U) {
        return fmt::format("The program is not square by {} mrad", withU(std::abs(s[0]), U));
      },
      advice(kPlanner)));
}

std::string fitsStep(const Evidence& evidence, double percent, int axis) {
  const double right =
      evidence.machine.gantry ? kMilli * evidence.machine.step_mm[axis] : evidence.machine.mirror_step_urad;
  return fmt::format("the drive's step is {:.5g} {}, {:.5g} fits what the release goes by", right,
                     evidence.machine.gantry ? "um" : "urad", right / (1.0 + percent / kPercent));
}

void ofSteps(const Evidence& evidence, std::vector<KnownCause>& list) {
  const auto add = [&](const char* key, const char* signature, const char* what, int axis) {
    list.push_back(linear(key, signature, kPercent, "%", scaleSaid(what), [evidence, axis](const Sizes& s) {
      return "check the step that the release was told: " + fitsStep(evidence, s[0], axis);
    }));
  };
  add("step_scale", "step", "The pulses make everything", 0);
  add("step_scale_x", "step_x", "Along x the pulses make everything", 0);
  add("step_scale_y", "step_y", "Along y the pulses make everything", 1);
  list.push_back({"pincushion_missing",
                  {"pincushion_missing", {}, {{"pincushion", 1.0}}},
                  {"pincushion"},
                  kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format("The formula against pincushion is left out ({} % of it is missing)",
                                       withU(s[0], U));
                  },
                  advice("the release aims as if x did not depend on the second mirror")});
  list.push_back({"table_missing",
                  {"table_missing", {}, {{"table", -1.0}}},
                  {"table"},
                  -kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format("The head's correction table is left out ({} % of it is missing)",
                                       withU(s[0], U));
                  },
                  advice("load the table of this head into the release")});
  list.push_back({"table_sign",
                  {"table_sign", {}, {{"table", -2.0}}},
                  {"table"},
                  -kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format(
                        "The head's correction table is applied with the wrong sign ({} % off)",
                        withU(s[0], U));
                  },
                  advice("the table's values are to be added to the aim")});
}

std::string countsSaid(const Evidence& evidence, double percent) {
  const double right = 1.0 / evidence.machine.encoder_count_mm;
  return fmt::format("check counts/mm: {:.4g} in the machine, {:.6g} fits what the release goes by", right,
                     right / (1.0 + percent / kPercent));
}

void ofBelt(const Evidence& evidence, std::vector<KnownCause>& list) {
  list.push_back(linear(
      "sheet_reference", "mark", 1.0, "mm", shiftSaid("Print mark or its sensor", "x"),
      advice("check the place of the print-mark sensor and of the eye mark that the release was told")));
  list.push_back(linear("encoder_scale", "encoder", kPercent, "%", scaleSaid("Encoder scale"),
                        [evidence](const Sizes& s) { return countsSaid(evidence, s[0]); }));
  list.push_back(linear(
      "latency", "latency", kMilli, "ms",
      [](const Sizes& s, double U) {
        return fmt::format("The place of the belt is {} ms {}", withU(std::abs(s[0]), U),
                           s[0] > 0.0 ? "old when it is used" : "ahead of the belt");
      },
      advice(
          "the deviation along x goes with the belt's speed: look for a delay between encoder and pulses")));
  // Where a unit begins is no matter of its speed.
  std::vector<std::string> begins{"mark"};
  for (const LineReading& line : evidence.lines) {
    const std::string key = fmt::format("mark_of_{}", line.unit);
    if (std::ranges::find(begins, key) == begins.end()) begins.push_back(key);
  }
  list.push_back({"mean_speed",
                  {"mean_speed", begins, {{"plan_speed", 1.0}}},
                  {"plan_speed"},
                  kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format(
                        "The planned speed of the belt is used in place of its encoder ({} % of the "
                        "belt's departures are not followed)",
                        withU(s[0], U));
                  },
                  advice("the cut is right at the begin of a unit and runs away with the belt's speed")});
  list.push_back({"belt_ignored",
                  {"belt_ignored", {"mark"}, {{"encoder", -1.0}}},
                  {"encoder"},
                  -kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format("The belt's motion is ignored ({} % of it is not followed)",
                                       withU(s[0], U));
                  },
                  advice("the release cuts as if the sheet were at rest")});
}

void ofHead(const Evidence& evidence, std::vector<KnownCause>& list) {
  const bool gantry = evidence.machine.gantry;
  list.push_back({"head_offset",
                  {"head_offset", {"head_x", "head_y"}},
                  {"head_x", "head_y"},
                  1.0,
                  "mm",
                  vectorSaid("Head or beam"),
                  advice("the pulses are right: check the zero of the axes and the beam's adjustment")});
  list.push_back(linear("head_rotation", "head_rotation", kMilli, "mrad",
                        angleSaid("The head's field is turned by"), advice("check how the head is mounted")));
  list.push_back(linear(
      "head_scale", "head_scale", kPercent, "%",
      scaleSaid("The beam goes farther or less far than its pulses say: everything is"),
      [evidence](const Sizes& s) {
        return evidence.machine.gantry
                   ? std::string("check travel per turn and gear of both axes")
                   : fmt::format(
                         "check the throw: {:.4g} mm by the data sheet, the beam behaves as at {:.5g} mm; "
                         "a focal length or an angle of the mirrors' step looks the same",
                         evidence.machine.throw_mm, evidence.machine.throw_mm * (1.0 + s[0] / kPercent));
      }));
  list.push_back(linear(
      "head_scale_x", "head_scale_x", kPercent, "%", scaleSaid("The beam's way along x is"),
      [evidence](const Sizes& s) {
        return evidence.machine.gantry
                   ? std::string("check travel per turn and gear of x")
                   : fmt::format(
                         "check the mirrors' spacing: {:.4g} mm by the data sheet, the beam behaves as at "
                         "{:.4g} mm; an angle of the first mirror's step looks the same",
                         evidence.machine.spacing_mm,
                         evidence.machine.spacing_mm +
                             s[0] / kPercent * (evidence.machine.throw_mm + evidence.machine.spacing_mm));
      }));
  list.push_back(linear("head_scale_y", "head_scale_y", kPercent, "%", scaleSaid("The beam's way along y is"),
                        advice(gantry ? "check travel per turn and gear of y"
                                      : "check the angle of the second mirror's step")));
  list.push_back(linear(
      "head_shear", "head_shear", kMilli, "mrad",
      [](const Sizes& s, double U) {
        return fmt::format("The axes are not square by {} mrad", withU(std::abs(s[0]), U));
      },
      advice("check the squareness of the axes")));
}

/// The correction table of a head that has one.
void ofTable(std::vector<KnownCause>& list) {
  list.push_back({"table_sign",
                  {"table_sign", {}, {{"head_table", 2.0}}},
                  {"head_table"},
                  kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format(
                        "The correction table has the wrong sign (the beam is off by {} % of it)",
                        withU(s[0], U));
                  },
                  advice("the table's values are to be added to the aim")});
  list.push_back({"table_other",
                  {"table_other", {}, {{"head_table", 1.0}}},
                  {"head_table"},
                  kPercent,
                  "%",
                  [](const Sizes& s, double U) {
                    return fmt::format(
                        "The correction table is not one of this head (the beam is off by {} % of it)",
                        withU(s[0], U));
                  },
                  advice("load the table that this head was calibrated with")});
}

void ofDrives(const Evidence& evidence, std::vector<KnownCause>& list) {
  const auto lag = [](const char* axes) {
    return [axes](const Sizes& s, double U) {
      return fmt::format("{} {} ms {} than the release was told", axes, withU(std::abs(s[0]), U),
                         s[0] > 0.0 ? "later" : "sooner");
    };
  };
  const double told_ms = kMilli * evidence.machine.tracking_delay_s;
  const auto tune = [told_ms](const Sizes& s) {
    return fmt::format("check the loops' bandwidth and the tracking delay: {:.4g} ms told, {:.4g} ms fits",
                       told_ms, told_ms + s[0]);
  };
  list.push_back(linear("axes_lag", "lag", kMilli, "ms", lag("The axes follow their pulses"), tune));
  list.push_back(linear("axis_lag_x", "lag_x", kMilli, "ms", lag("X follows its pulses"), tune));
  list.push_back(linear("axis_lag_y", "lag_y", kMilli, "ms", lag("Y follows its pulses"), tune));
  list.push_back(linear(
      "loop_soft", "sway", 1e6, "um per m/s2",
      [](const Sizes& s, double U) {
        return fmt::format("The axes give way by {} um for each m/s² that they are asked for",
                           withU(s[0], U));
      },
      advice("a loop too slow, a resonance or too hard a jerk: hooks at starts and corners; ask for less "
             "acceleration or jerk")));
  // A loop that trails more also swings otherwise; friction winds up what is behind a play.
  constexpr double kSecondOrder = 0.03;
  for (KnownCause& cause : list)
    if (cause.unit == "ms" && cause.key != "latency") cause.model = kSecondOrder;
  for (KnownCause& cause : list)
    cause.only_positive = cause.key == "loop_soft" || cause.key.starts_with("backlash");
  for (const char* const axis : {"X", "Y"}) {
    const std::string key = *axis == 'X' ? "backlash_x" : "backlash_y";
    list.push_back(linear(
        key, key, 1.0, "mm",
        [axis](const Sizes& s, double U) {
          return fmt::format("{} has a play of {} mm", axis, withU(s[0], U));
        },
        advice("lines that are cut the other way lie aside: check belt, pinion and coupling of that axis")));
    list.back().model = kSecondOrder;
  }
}

}  // namespace

std::string withU(double value, double U) {
  if (!(U > 0.0) || !std::isfinite(U)) return fmt::format("{:.3g}", value);
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(U))), 0, 6);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, U, digits);
}

std::vector<KnownCause> knownCauses(const Evidence& evidence) {
  std::vector<KnownCause> list;
  ofProgram(list);
  ofSteps(evidence, list);
  if (evidence.sheet_moves) ofBelt(evidence, list);
  ofHead(evidence, list);
  if (evidence.machine.has_table) ofTable(list);
  ofDrives(evidence, list);
  return list;
}

}  // namespace kerfbench::diagnose
