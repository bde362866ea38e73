// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/verdict/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "hil/inspect/verdict/uncertainty.h"

namespace kerfbench::inspect {

std::string_view verdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "PASS";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kNotProven:
      return "NOT PROVEN";
    case Verdict::kInvalid:
      break;
  }
  return "INVALID";
}

int exitCode(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return 0;
    case Verdict::kFail:
      return 1;
    case Verdict::kNotProven:
      return 4;
    case Verdict::kInvalid:
      break;
  }
  return 3;
}

Verdict decide(Check& check) {
  const bool usable = std::isfinite(check.value) && std::isfinite(check.limit) &&
                      std::isfinite(check.guard) && std::isfinite(check.u) && check.guard >= 0.0 &&
                      check.u >= 0.0;
  if (!usable) return check.verdict = Verdict::kInvalid;
  // How far the value lies beyond the limit, counted positive on the bad side.
  const double excess = check.upper ? check.value - check.limit : check.limit - check.value;
  if (excess > check.guard) return check.verdict = Verdict::kFail;
  if (excess <= -check.guard) return check.verdict = Verdict::kPass;
  return check.verdict = Verdict::kNotProven;
}

namespace {

std::string percent(double chance) {
  if (chance < 1e-5) return "below 0.001 %";
  if (chance > 1.0 - 1e-5) return "above 99.999 %";
  return fmt::format("{:.2g} %", 100.0 * chance);
}

}  // namespace

double shareOfLimit(const Check& check) {
  const bool says = check.upper && check.limit > 0.0 && std::isfinite(check.value);
  return says ? check.value / check.limit : -1.0;
}

Verdict decideAtLeast(Check& check) {
  check.at_least = decide(check) == Verdict::kFail;
  if (check.at_least) return check.verdict;
  check.value = std::numeric_limits<double>::quiet_NaN();
  return decide(check);
}

std::string riskSentence(Check& check) {
  if (check.verdict == Verdict::kInvalid || !(check.u > 0.0) || !(check.guard > 0.0)) return {};
  if (std::isnan(check.chance_beyond)) {
    const double above = chanceAboveNormal(check.limit, {check.value, check.u});
    check.chance_beyond = check.upper ? above : 1.0 - above;
  }
  const bool share = check.unit == "share";
  const std::string unit = share ? " %" : check.unit.empty() ? "" : " " + check.unit;
  const std::string limit = fmt::format("{:.3g}{}", (share ? 100.0 : 1.0) * check.limit, unit);
  if (check.verdict == Verdict::kFail) {
    return fmt::format("The chance that a sheet with this reading is in truth within {} is {}.", limit,
                       percent(1.0 - check.chance_beyond));
  }
  return fmt::format("The chance that a sheet with this reading is in truth beyond {} is {}.", limit,
                     percent(check.chance_beyond));
}

Verdict combine(const std::vector<Check>& checks, bool evidence_valid) {
  const auto any = [&](Verdict verdict) {
    return std::any_of(checks.begin(), checks.end(), [&](const Check& c) { return c.verdict == verdict; });
  };
  if (!evidence_valid || checks.empty()) return Verdict::kInvalid;
  // A proven fault stays one, even if it kept another check from being measured.
  if (any(Verdict::kFail)) return Verdict::kFail;
  if (any(Verdict::kInvalid)) return Verdict::kInvalid;
  if (any(Verdict::kNotProven)) return Verdict::kNotProven;
  return Verdict::kPass;
}

}  // namespace kerfbench::inspect
