// SPDX-License-Identifier: Apache-2.0
#include "hil/report/headline.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/inspect/evidence/places.h"
#include "hil/report/causes.h"

namespace kerfbench::report {

using inspect::Whereabouts;

std::string howMuchOf(const inspect::Check& check) {
  if (std::isnan(check.value)) return "it could not be measured";
  // What lies beyond the reach of a measurement has a bound and no U.
  const std::string value = check.at_least
                                ? "at least " + checkNumber(check, std::max(0.0, check.value - check.u))
                                : checkNumber(check, check.value);
  const std::string u = check.u > 0.0 && !check.at_least ? " ± " + checkNumber(check, check.u) : "";
  return check.upper ? fmt::format("{}{}, where {} is allowed", value, u, checkNumber(check, check.limit))
                     : fmt::format("{}{} of margin, where {} is asked for", value, u,
                                   checkNumber(check, check.limit));
}

std::string whereOf(const inspect::Check& check) {
  const Whereabouts& where = check.where;
  std::string text = check.subject;
  if (where.unit >= 0 && where.entity >= 0) {
    text = inspect::checks::nameOf(where.unit, where.entity);
  } else if (where.unit >= 0) {
    text = fmt::format("unit {}", where.unit);
  }
  if (!where.hasPlace() || where.time == Whereabouts::Time::kMidway) return text;
  return text + (text.empty() ? "" : " at ") + inspect::checks::placeOf({where.x_mm, where.y_mm});
}

std::string whenOf(const Whereabouts& where) {
  switch (where.time) {
    case Whereabouts::Time::kNone:
      break;
    case Whereabouts::Time::kPins:
      return fmt::format("{:.6f} s, by the pins", where.time_s);
    case Whereabouts::Time::kFrame:
      return fmt::format("{:.4f} s, in a frame of the spot camera", where.time_s);
    case Whereabouts::Time::kPassing:
      return fmt::format("{:.4f} s ± {:.2g} ms, when the beam passed that place", where.time_s,
                         1e3 * where.within_s);
    case Whereabouts::Time::kMidway:
      return fmt::format("{:.4f} s, when the beam passed the middle of the line, which is judged as a whole",
                         where.time_s);
  }
  return {};
}

namespace {

/// The likely cause, if it explains most of the deviation; else where that arises.
std::string explainingCause(const RunReport& report) {
  const diagnose::Diagnosis& diagnosis = report.diagnosis;
  const bool is_explained = !diagnosis.causes.empty() && diagnose::explainsMost(diagnosis.causes.front());
  return is_explained ? diagnosis.causes.front().sentence : diagnosis.arises;
}

}  // namespace

Headline headlineOf(const RunReport& report) {
  Headline headline;
  headline.cause = explainingCause(report);
  if (report.result.verdict == inspect::Verdict::kPass) return headline;
  const auto groups = failureGroups(report.result.checks, report.result.verdict);
  if (groups.empty()) return headline;
  const inspect::Check& check = *groups.front().primary;
  headline.check = check.name;
  headline.what = report.result.verdict == inspect::Verdict::kFail ? failingPhrase(check.name) : check.title;
  headline.how_much = howMuchOf(check);
  headline.where = whereOf(check);
  headline.when = whenOf(check.where);
  return headline;
}

}  // namespace kerfbench::report
