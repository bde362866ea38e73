// SPDX-License-Identifier: Apache-2.0
// What to do after a verdict that proves nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/report/headline.h"

namespace kerfbench::report {
namespace {

/// A step to take where a problem of the evidence has one of these words; the first that fits counts.
struct Remedy {
  std::array<std::string_view, 4> words;
  std::string_view step;
};

constexpr std::array kRemedies{
    Remedy{{"time limit", "", "", ""},
           "See in pins.vcd whether the job was still under way at the end. If so, raise time_limit_s in the "
           "scenario or give --time-limit; if not, find what the controller waited for."},
    Remedy{
        {"crashed", "", "", ""},
        "The firmware or its emulator crashed: look at the last events in pins.vcd, and run the image in a "
        "debugger up to that time."},
    Remedy{{"gate was never opened", "Nothing was provoked", "laser was dark", ""},
           "See in pins.vcd whether the job began. Compare `signals.laser_gate` and `laser.gate_low` of the "
           "machine file with the wiring, and what the controller said with what its dialog expects."},
    Remedy{{"sum at its end", "damaged", "", ""},
           "Take the file as it was recorded: this one was cut, edited or converted."},
    Remedy{{"area that", "", "", ""},
           "Calibrate the camera over the whole area in which the job lies "
           "(docs/how-to/calibrate-a-camera.md)."},
    Remedy{{"calibration", "", "", ""},
           "Calibrate the camera that is named, or name its calibration in the scenario "
           "(docs/how-to/calibrate-a-camera.md)."},
    Remedy{
        {"clock", "stamp", "", ""},
        "See that camera and pins are stamped as the scenario says; `kerfbench doctor` shows the clocks of "
        "this computer."},
    Remedy{{"frames", "spot camera", "frame ", ""},
           "See that the spot camera runs all through the job and keeps pace: fewer frames per second, a "
           "smaller picture or a faster line. Then run it again."},
    Remedy{
        {"mark", "", "", ""},
        "See that the printed marks lie where `print` of the scenario has them, are clean and lit, and stay "
        "in view of the camera. Then take the pictures again."},
    Remedy{{"tile", "picture", "kerf readings", "scanned"},
           "Take the pictures of the cut sheet again, all of them and of one sheet."},
    Remedy{{"encoder", "belt", "", ""},
           "See that both channels of the belt's encoder are wired and recorded, and that its count in the "
           "machine file is that of the roller."},
    Remedy{{"edges", "lost", "gap", "bounces"},
           "The pins were not recorded whole: shorten or shield the lines, record fewer of them, or use a "
           "faster analyser. `kerfbench doctor` shows what this computer can do."},
    Remedy{{"controller said", "reports", "words", ""},
           "See that the controller's UART is connected both ways at the rate of `firmware.baud`, and that "
           "`firmware.dialog` is its own."},
};

constexpr std::string_view kAnyProblem =
    "Remove what the problem names and run the scenario again: INVALID says nothing of the release.";

std::string_view remedyFor(const std::string& problem) {
  for (const Remedy& remedy : kRemedies) {
    const bool fits = std::ranges::any_of(remedy.words, [&](std::string_view word) {
      return !word.empty() && problem.find(word) != std::string::npos;
    });
    if (fits) return remedy.step;
  }
  return kAnyProblem;
}

/// For a check that could not be measured.
std::string stepForUnmeasured(const inspect::Check& check) {
  if (check.name == "belt")
    return "belt: encoder and pictures cannot both be right. Measure the sheet's way over the count of "
           "edges, "
           "and compare it with the roller in the machine file and with the pitch of the printed marks.";
  if (check.name == "spot_seen")
    return "spot_seen: laser or camera? See whether the kerf is there where the frames are dark. If it is, "
           "raise the camera's exposure or clear its view; if not, look for the laser's fault.";
  return fmt::format("{}: {}", check.name, check.explanation);
}

std::string stepForUnproven(const inspect::Check& check) {
  const double margin = check.upper ? check.limit - check.value : check.value - check.limit;
  if (margin > 0.0)
    return fmt::format(
        "{}: the value keeps its limit by {}, and is known to ± {} only. A measurement with U below {} would "
        "prove it good; see below what U is made of.",
        check.name, checkNumber(check, margin), checkNumber(check, check.guard), checkNumber(check, margin));
  return fmt::format(
      "{}: the value is beyond its limit by {}, and is known to ± {} only. A release that is better by {} "
      "would be proven good; a measurement with U below {} would prove this one bad.",
      check.name, checkNumber(check, -margin), checkNumber(check, check.guard),
      checkNumber(check, check.guard - margin), checkNumber(check, -margin));
}

}  // namespace

std::vector<std::string> nextSteps(const RunReport& report) {
  std::vector<std::string> steps;
  const auto add = [&](std::string step) {
    if (std::ranges::find(steps, step) == steps.end()) steps.push_back(std::move(step));
  };
  const inspect::InspectionResult& result = report.result;
  if (result.verdict == inspect::Verdict::kInvalid) {
    for (const std::string& problem : result.problems) add(std::string(remedyFor(problem)));
    for (const inspect::Check& check : result.checks)
      if (check.verdict == inspect::Verdict::kInvalid) add(stepForUnmeasured(check));
    if (steps.empty()) add(std::string(kAnyProblem));
  }
  if (result.verdict == inspect::Verdict::kNotProven) {
    for (const inspect::Check& check : result.checks)
      if (check.verdict == inspect::Verdict::kNotProven) add(stepForUnproven(check));
  }
  return steps;
}

}  // namespace kerfbench::report
