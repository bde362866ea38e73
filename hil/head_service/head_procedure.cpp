// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_procedure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/marks/mark_code.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/calibrate/marks/verify_places.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;

constexpr double kNoBetter = 0.9;
constexpr double kSheetX_mm = -67.0;  // S is not W: whoever takes one for the other is off by this
constexpr double kPrintDiameter_mm = 3.0;

std::vector<RegistrationMark> printFor(const HeadSetup& setup, const Vector2d& p_SW_mm) {
  const double beyond_mm =
      0.5 * (calibrate::kMarkReach * setup.mark_size_mm + kPrintDiameter_mm) + setup.off_mm;
  const Eigen::AlignedBox2d field(setup.field_W_mm.min() - Vector2d::Constant(beyond_mm),
                                  setup.field_W_mm.max() + Vector2d::Constant(beyond_mm));
  std::vector<RegistrationMark> print;
  // Not symmetrical: the sheet has one way to lie.
  for (const double u : {0.0, 0.55, 1.0}) {
    for (const double v : {0.0, 1.0})
      print.push_back(
          {p_SW_mm + field.min() + Vector2d(u, v).cwiseProduct(field.sizes()), kPrintDiameter_mm});
  }
  return print;
}

/// Numbers that no sheet before has, as long as there are any.
class Numbers {
 public:
  int take(std::size_t count) {
    if (next_ + static_cast<int>(count) > calibrate::kMarkNumbers) next_ = 0;
    const int first = next_;
    next_ += static_cast<int>(count);
    return first;
  }

 private:
  int next_{0};
};

/// Marks that were cut with the head's table.
std::vector<calibrate::HeadObservation> verifyingMarks(const FittedHead& head,
                                                       const std::vector<MeasuredSheet>& sheets) {
  std::vector<calibrate::HeadObservation> seen;
  int number = 0;
  for (const MeasuredSheet& sheet : sheets) {
    for (const calibrate::HeadObservation& o : observationsOf(sheet, head.table.grid, number++))
      seen.push_back(o);
  }
  return seen;
}

calibrate::VerifiedTable verified(const FittedHead& head, const HeadSetup& setup,
                                  const std::vector<calibrate::HeadObservation>& marks) {
  return calibrate::verifiedTable(head.fit, head.table.grid, setup.controller_W_mm, marks);
}

std::string lengthWords(const calibrate::LargestError& largest) {
  return fmt::format("{:.4f} ± {:.4f} mm", largest.value_mm, largest.U_mm);
}

std::vector<Vector2d> middlesOf(const calibrate::AimGrid& table) {
  std::vector<Vector2d> middles;
  for (std::size_t row = 0; row + 1 < table.y_mm().size(); ++row) {
    for (std::size_t column = 0; column + 1 < table.x_mm().size(); ++column) {
      middles.emplace_back(0.5 * (table.x_mm()[column] + table.x_mm()[column + 1]),
                           0.5 * (table.y_mm()[row] + table.y_mm()[row + 1]));
    }
  }
  return middles;
}

/// A table whose statement holds before one that is nearer.
bool isBetter(const HeadIteration& now, const HeadIteration& best, double limit_mm) {
  if (now.holds(limit_mm) != best.holds(limit_mm)) return now.holds(limit_mm);
  return now.table.largest.value_mm < best.table.largest.value_mm;
}

/// What the rounds share.
class Rounds {
 public:
  Rounds(const HeadSetup& setup, const HeadPlan& plan, const CutAndMeasure& cut)
      : setup_(setup), plan_(plan), cut_(cut), table_(setup.table) {}

  HeadIteration next(int grid) {
    const std::vector<Vector2d> places = calibrate::gridPlaces(setup_.field_W_mm, grid);
    marked_.insert(marked_.end(), places.begin(), places.end());
    const MeasuredSheet marks = measured(places, fmt::format("{}-grid", round_ + 1));
    for (const calibrate::HeadObservation& o : observationsOf(marks, table_, round_))
      observations_.push_back(o);
    HeadIteration iteration{.grid = grid,
                            .marks = marks,
                            .before = errorsOf({&marks, 1}),
                            .head = fitted(observations_, setup_),
                            .verified = {},
                            .after = {},
                            .spread = {},
                            .table = {}};
    table_ = iteration.head.table.grid;
    ++round_;
    int part = 0;
    for (const std::vector<Vector2d>& some : placesToVerify()) {
      iteration.verified.push_back(measured(some, fmt::format("{}-verify-{}", round_, ++part)));
    }
    iteration.after = errorsOf(iteration.verified);
    const auto marks_that_verify = verifyingMarks(iteration.head, iteration.verified);
    iteration.spread = calibrate::statedSpread(iteration.head.fit, marks_that_verify);
    iteration.table = verified(iteration.head, setup_, marks_that_verify);
    return iteration;
  }

 private:
  std::vector<std::vector<Vector2d>> placesToVerify() const {
    try {
      return calibrate::verifySheets(setup_.field_W_mm,
                                     {.count = plan_.verify,
                                      .mark_size_mm = setup_.mark_size_mm,
                                      .marked = marked_,
                                      .middles = middlesOf(*table_),
                                      .seed = 4 * plan_.seed + static_cast<std::uint64_t>(round_)});
    } catch (const std::invalid_argument& error) {
      throw base::ConfigError(fmt::format("{}: {}", setup_.machine.string(), error.what()));
    }
  }

  MeasuredSheet measured(const std::vector<Vector2d>& places_mm, const std::string& name) {
    const int first = numbers_.take(places_mm.size());
    return cut_({planSheet(setup_, plan_, name, places_mm, first), sheet_++, round_, table_});
  }

  const HeadSetup& setup_;
  const HeadPlan& plan_;
  const CutAndMeasure& cut_;
  std::optional<calibrate::AimGrid> table_;
  std::vector<calibrate::HeadObservation> observations_;
  std::vector<Vector2d> marked_;
  Numbers numbers_;
  int round_{0}, sheet_{0};  // Rounds whose table is made.
};

}  // namespace

FittedHead fitted(const std::vector<calibrate::HeadObservation>& observations, const HeadSetup& setup) {
  calibrate::HeadFitOptions options;
  options.field_W_mm = setup.controller_W_mm;
  options.tolerances.unmodelled_share = setup.unmodelled_share;
  options.round_steps = false;  // Arms run along no axis: the steps average out along them.
  calibrate::HeadFit fit = calibrate::fitHead(observations, setup.nominal, setup.design, options);
  calibrate::CorrectionTableOptions grid;
  grid.field_W_mm = setup.controller_W_mm;
  calibrate::CorrectionTableResult table = calibrate::correctionTable(fit, grid);
  return {std::move(fit), std::move(table)};
}

calibrate::MarkJob planSheet(const HeadSetup& setup, const HeadPlan& plan, const std::string& name,
                             const std::vector<Vector2d>& places_mm, int first_number) {
  calibrate::MarkJob job;
  job.name = name;
  job.machine = setup.name;
  job.date = plan.date;
  job.size_mm = setup.mark_size_mm;
  job.p_SW_mm = {kSheetX_mm, 0.0};
  job.print = printFor(setup, job.p_SW_mm);
  job.marks = calibrate::numbered(places_mm, first_number);
  std::vector<std::string> faults;
  for (const calibrate::MarkJobFault& fault : job.faults())
    faults.push_back(fmt::format("job {}: {}: {}", name, fault.key, fault.message));
  if (!faults.empty()) throw base::ConfigError(fmt::format("{}", fmt::join(faults, "\n")));
  return job;
}

HeadCalibration calibrateHead(const HeadSetup& setup, const HeadPlan& plan, const CutAndMeasure& cut,
                              const std::function<void(const HeadIteration&)>& told) {
  HeadCalibration result;
  result.end = HeadEnd::kGridsUsed;
  Rounds rounds(setup, plan, cut);
  double least_mm = INFINITY;
  for (const int grid : plan.grids) {
    result.iterations.push_back(rounds.next(grid));
    const HeadIteration& now = result.iterations.back();
    told(now);
    if (isBetter(now, result.iterations[result.best], plan.limit_mm))
      result.best = result.iterations.size() - 1;
    if (now.holds(plan.limit_mm)) break;
    if (now.table.largest.value_mm > kNoBetter * least_mm) {
      result.end = HeadEnd::kNoBetter;
      break;
    }
    least_mm = std::min(least_mm, now.table.largest.value_mm);
  }
  result.verdict = result.iterations.at(result.best).check(plan.limit_mm).verdict;
  if (result.good()) result.end = HeadEnd::kGood;
  return result;
}

HeadCalibration calibrateHeadOnce(const HeadSetup& setup, const HeadPlan& plan, const MeasuredSheet& sheet) {
  HeadCalibration result;
  result.iterations.push_back({.grid = 0,
                               .marks = sheet,
                               .before = errorsOf({&sheet, 1}),
                               .head = fitted(observationsOf(sheet, setup.table, 0), setup),
                               .verified = {},
                               .after = {},
                               .spread = {},
                               .table = {}});
  HeadIteration& only = result.iterations.back();
  only.table = verified(only.head, setup, {});
  result.verdict = only.check(plan.limit_mm).verdict;
  result.end = HeadEnd::kNotVerified;
  return result;
}

inspect::Check HeadIteration::check(double limit_mm) const {
  inspect::Check check;
  check.name = "head";
  check.title = "Largest error of the beam";
  check.unit = "mm";
  check.value = table.largest.value_mm;
  check.limit = limit_mm;
  check.u = check.guard = table.largest.U_mm;
  check.where.x_mm = table.largest.p_W_mm.x();
  check.where.y_mm = table.largest.p_W_mm.y();
  inspect::decide(check);
  return check;
}

std::string_view HeadCalibration::verdictName() const {
  switch (verdict) {
    case inspect::Verdict::kPass:
      return end == HeadEnd::kNotVerified ? "NOT VERIFIED" : "GOOD";
    case inspect::Verdict::kFail:
      return "NOT GOOD";
    case inspect::Verdict::kNotProven:
      return "NOT PROVEN";
    case inspect::Verdict::kInvalid:
      break;
  }
  return "INVALID";
}

std::string HeadCalibration::endWords(const HeadPlan& plan) const {
  const HeadIteration& it = iterations.at(best);
  const std::string largest = lengthWords(it.table.largest);
  if (end == HeadEnd::kNotVerified) {
    return fmt::format(
        "{}: fitted and not verified; anywhere in the field the beam should be off by {} at most (k = 2), "
        "the "
        "limit is {:g} mm; cut other marks with the table to see",
        verdictName(), largest, plan.limit_mm);
  }
  std::string why;
  if (!good() && end == HeadEnd::kNoBetter) why = "a denser grid no longer improves it; ";
  if (!good() && end == HeadEnd::kGridsUsed) why = "after the last grid ";
  return fmt::format(
      "{}: {}the beam is off by {} at most anywhere in the field (k = 2); the limit is {:g} mm. Measured at "
      "{} "
      "places: {:.4f} mm at most, {:.4f} mm RMS{}",
      verdictName(), why, largest, plan.limit_mm, it.after.marks, it.after.max_mm, it.after.rms_mm,
      it.spread.holds() ? "" : "; by what the fit alone states " + it.spread.words());
}

std::string parameterWords(const calibrate::HeadParameterFinding& finding) {
  const calibrate::HeadParameterText text = calibrate::textOf(finding.which);
  const std::string unit = text.unit.empty() ? "" : fmt::format(" {}", text.unit);
  const std::string value =
      fmt::format("{}: {:+.3g} ± {:.1g}{}", text.name, finding.value, 2.0 * finding.sigma, unit);
  if (finding.held) return value;
  if (!finding.mixed_with) return value + ", not held by the marks";
  return value + fmt::format(", not told from: {}", calibrate::textOf(*finding.mixed_with).name);
}

}  // namespace kerfbench::head_service
