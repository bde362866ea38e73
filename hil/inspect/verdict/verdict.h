// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerfbench::inspect {

enum class Verdict { kPass, kFail, kInvalid, kNotProven };
std::string_view verdictName(Verdict verdict);  ///< "PASS", "FAIL", "INVALID", "NOT PROVEN"
int exitCode(Verdict verdict);                  ///< 0, 1, 3, 4

/// Where on the sheet, and when, the value of a check was found. What is not known is negative or NaN.
struct Whereabouts {
  /// What the time is that of.
  enum class Time {
    kNone,     ///< Not known.
    kPins,     ///< An edge or a span of the pins.
    kFrame,    ///< A frame of the spot camera.
    kPassing,  ///< The beam passed that place, as the spot camera's frames have it.
    kMidway,   ///< The same of the middle of a line that is judged as a whole.
  };
  int unit{-1};
  int entity{-1};
  double x_mm{std::numeric_limits<double>::quiet_NaN()};  ///< On the sheet of that unit, S.
  double y_mm{std::numeric_limits<double>::quiet_NaN()};
  Time time{Time::kNone};
  double time_s{std::numeric_limits<double>::quiet_NaN()};  ///< On the clock of the pins.
  double within_s{};  ///< Half of the time between the frames on either side; 0 of a time of the pins.
  /// Where the value is a time between two instants the other one, on the same clock; else NaN.
  double other_s{std::numeric_limits<double>::quiet_NaN()};

  [[nodiscard]] bool hasPlace() const { return !std::isnan(x_mm) && !std::isnan(y_mm); }
  [[nodiscard]] bool hasTime() const { return !std::isnan(time_s); }
};

/// One check of a verdict quantity against its limit.
struct Check {
  std::string name{};     ///< "path" or "edge", "joints", "coverage", "bridges", "depth", "even_depth",
                          ///< "ordered_depth", "line_energy", "perforation", "kerf_width", "ordered_width",
                          ///< "stray", "laser_timing", "stillness_x", "stillness_peak", "belt", "spot_seen",
                          ///< "spot_path", "repeat", "dwell", "laser_gate", "interlock", "pulse_timing",
                          ///< "account", "finish", "safe_state", "safe_stop", "safe_report"
  std::string title{};    ///< For people.
  std::string subject{};  ///< Where the worst value was: "unit 2, E14", an axis, ….
  std::string unit{};     ///< "mm", "us", "ms", "steps", "counts", "stops"; "share": of one; "": a number
  double value{};         ///< The worst; NaN if nothing was measured (then INVALID).
  double limit{};         ///< The value itself may equal it when w = 0.
  bool upper{true};       ///< True: value must not exceed limit; false: not fall below it.
  double guard{};         ///< w: half the width of the guard band, same unit. 0 for counted quantities.
  double u{};             ///< Expanded uncertainty U (k = 2) of the value.
  /// Chance that the true value lies beyond the limit; NaN where the value is counted or was not measured.
  double chance_beyond{std::numeric_limits<double>::quiet_NaN()};
  Verdict verdict{Verdict::kInvalid};
  std::string explanation{};  ///< One sentence a QA engineer understands.
  Whereabouts where{};        ///< Place and time of the worst value; no verdict depends on it.
  /// True: the value is the farthest that the measurement reaches, and the truth lies there or beyond.
  bool at_least{};
};

/// The share of its limit that the value of a check takes, > 0; -1 where that says nothing: a lower limit,
/// one of 0, or no value.
double shareOfLimit(const Check& check);

/// A check that says nothing of a run, and why. A run names every check: each is judged, or one of these.
struct Unjudged {
  std::string name{};    ///< As Check::name.
  std::string title{};   ///< For people.
  bool applies{};        ///< True: the job has what it judges, and it could not be judged; false: it has not.
  std::string reason{};  ///< One sentence a QA engineer understands.
};

/// What came of a check: a decided Check, or why there is none.
class Finding {
 public:
  Finding(Check check) : check_(std::move(check)) {}         // NOLINT(google-explicit-constructor)
  Finding(Unjudged unjudged) : why_(std::move(unjudged)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool has_value() const { return check_.has_value(); }
  explicit operator bool() const { return check_.has_value(); }
  /// @throws std::bad_optional_access where there is no Check.
  [[nodiscard]] const Check& operator*() const { return check_.value(); }
  [[nodiscard]] const Check* operator->() const { return &check_.value(); }
  /// Meaningful where there is no Check.
  [[nodiscard]] const Unjudged& why() const { return why_; }

 private:
  std::optional<Check> check_;
  Unjudged why_;
};

/// The job has nothing that this check judges. Name and title are taken from `check`.
inline Unjudged notApplicable(const Check& check, std::string reason) {
  return {check.name, check.title, false, std::move(reason)};
}
/// The job has it, and it could not be judged.
inline Unjudged notJudged(const Check& check, std::string reason) {
  return {check.name, check.title, true, std::move(reason)};
}

/// Decision rule of JCGM 106 with guard band: PASS inside limit - w, FAIL outside limit + w, NOT PROVEN
/// between, INVALID for NaN. Sets check.verdict and returns it.
Verdict decide(Check& check);
/// The same for a value that is the farthest that the measurement reaches: FAIL where even that is outside
/// limit + w, else INVALID, for what lies beyond is not known; the value is NaN then. Sets check.at_least.
Verdict decideAtLeast(Check& check);
/// For a decided check with an uncertainty: the risk of deciding wrongly (JCGM 106, 8 and 9), in one
/// sentence; empty for others. Sets chance_beyond, if it is not known better, from a normal truth about the
/// value.
std::string riskSentence(Check& check);
/// INVALID without valid evidence or without any check; else FAIL if any check proves it, INVALID if one
/// could not be measured, NOT PROVEN if any is; else PASS.
Verdict combine(const std::vector<Check>& checks, bool evidence_valid);

}  // namespace kerfbench::inspect
