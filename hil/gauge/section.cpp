// SPDX-License-Identifier: Apache-2.0
// Results of cases as findings about the instrument.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "hil/gauge/gauge.h"
#include "twin/base/constants.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;
using Named = std::pair<std::string, Reading>;

constexpr const char* kWorstOfAll = "worst of all lines";
constexpr const char* kLargestDrift = "largest drift of all cuts";
constexpr double kFieldCell_mm = 5.0;

template <typename Outcome>
const Reading* readingOf(const Outcome& outcome, std::string_view quantity) {
  for (const Reading& r : outcome.readings) {
    if (r.quantity == quantity) return &r;
  }
  return nullptr;
}

template <typename Outcome>
void collect(const Outcome& outcome, std::vector<std::string>& order,
             std::map<std::string, std::vector<Named>>& by) {
  for (const Reading& r : outcome.readings) {
    if (!by.contains(r.quantity)) order.push_back(r.quantity);
    by[r.quantity].emplace_back(outcome.name, r);
  }
}

bool isJoint(FaultKind kind) { return kind == FaultKind::kCorner || kind == FaultKind::kEnd; }

BudgetCheck budgetCheck(const std::vector<double>& analytic, const std::vector<double>& simulated,
                        const std::vector<double>& error) {
  BudgetCheck b;
  b.cases = analytic.size();
  if (analytic.empty()) return b;
  std::vector<double> ratio;
  std::vector<double> departure;
  double errors = 0.0;
  double stated = 0.0;
  for (std::size_t i = 0; i < analytic.size(); ++i) {
    ratio.push_back(analytic[i] / simulated[i]);
    departure.push_back(std::abs(ratio.back() - 1.0));
    errors += error[i] * error[i];
    stated += 0.25 * simulated[i] * simulated[i];
  }
  b.median_ratio = quantileOf(ratio, 0.5);
  b.p95_departure = quantileOf(departure, 0.95);
  b.within_10_percent =
      static_cast<double>(std::ranges::count_if(departure, [](double d) { return d <= 0.1; })) /
      static_cast<double>(departure.size());
  b.observed_ratio = std::sqrt(errors / stated);
  return b;
}

/// Errors along normals of all directions in a cell, put together to a vector by least squares.
std::vector<FieldCell> fieldOf(const std::vector<FieldError>& errors) {
  struct Sums {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Vector2d right = Vector2d::Zero();
    double squares{};
    std::size_t count{};
  };
  std::map<std::pair<int, int>, Sums> cells;
  for (const FieldError& e : errors) {
    Sums& s = cells[{static_cast<int>(std::floor(e.p_V_mm.x() / kFieldCell_mm)),
                     static_cast<int>(std::floor(e.p_V_mm.y() / kFieldCell_mm))}];
    s.normal += e.normal * e.normal.transpose();
    s.right += e.error_mm * e.normal;
    s.squares += e.error_mm * e.error_mm;
    ++s.count;
  }
  std::vector<FieldCell> field;
  for (const auto& [key, s] : cells) {
    const SymmetricEigen<2> solver(s.normal);
    if (s.count < 10 || solver.values[0] < 2.0) continue;
    FieldCell cell;
    cell.p_V_mm = kFieldCell_mm * Vector2d(key.first + 0.5, key.second + 0.5);
    cell.bias_mm = solver.vectors * (solver.vectors.transpose() * s.right).cwiseQuotient(solver.values);
    const double rest = std::max(0.0, s.squares - cell.bias_mm.dot(s.right));
    cell.sigma_mm = std::sqrt(rest / static_cast<double>(s.count - 2) / solver.values[0]);
    cell.readings = s.count;
    field.push_back(cell);
  }
  return field;
}

/// How far the truth lies above the lower end of what is stated: a cut is FAIL once its truth exceeds the
/// limit by that.
KindResult kindOf(FaultKind kind, const std::vector<std::pair<CaseId, KerfOutcome>>& cases) {
  KindResult k;
  k.kind = kind;
  k.detectable_mm = kNan;
  std::vector<double> margin;
  std::size_t fails = 0;
  for (const auto& [id, o] : cases) {
    const bool bad = id.study == Study::kBad;
    if ((!bad && id.study != Study::kGood) || o.kind != kind) continue;
    ++(bad ? k.bad : k.good)[o.verdict];
    if (bad && o.verdict == inspect::Verdict::kFail) ++fails;
    const Reading* r = readingOf(o, kWorstOfAll);
    if (r != nullptr && std::isfinite(r->U)) margin.push_back(r->truth - (r->value - r->U));
  }
  k.detectable_from = margin.size();
  if (isJoint(kind) || fails == 0) return k;
  if (const auto bound = upperToleranceBound(margin)) k.detectable_mm = 0.5 * kTolerance_mm + *bound;
  return k;
}

void addVerdicts(const CaseId& id, const KerfOutcome& o, GaugeSection& s) {
  if (id.study != Study::kBad && id.study != Study::kGood) return;
  const bool bad = id.study == Study::kBad;
  ++(bad ? s.bad : s.good)[o.verdict];
  if (o.verdict == (bad ? inspect::Verdict::kPass : inspect::Verdict::kFail) ||
      o.verdict == inspect::Verdict::kInvalid || (!bad && o.verdict == inspect::Verdict::kNotProven)) {
    s.wrong.push_back(fmt::format("{}: {} with a true deviation of {:.1f} µm ({}){}", o.name,
                                  inspect::verdictName(o.verdict), 1e3 * o.truth_mm, faultName(o.kind),
                                  o.problems.empty() ? "" : "; " + o.problems.front()));
  }
  if (isJoint(o.kind)) s.joints.push_back({o.name, o.kind, o.verdict, o.truth_mm, kNan, kNan});
}

void addKerf(const std::vector<std::pair<CaseId, KerfOutcome>>& cases, GaugeSection& s) {
  std::vector<FieldError> field;
  std::vector<double> analytic;
  std::vector<double> simulated;
  std::vector<double> error;
  std::vector<double> grr;
  std::vector<double> truth;
  for (const auto& [id, o] : cases) {
    addVerdicts(id, o, s);
    const Reading* r = readingOf(o, kWorstOfAll);
    const double value = r == nullptr ? kNan : r->value;
    const double off = r == nullptr ? kNan : r->value - r->truth;
    if (id.study == Study::kRepeat) s.repeat_mm.push_back(off);
    if (id.study == Study::kRelay) s.relay_mm.push_back(off);
    if (id.study == Study::kGrr) grr.push_back(value);
    if (id.study == Study::kBad || id.study == Study::kGood || id.study == Study::kCoverage) {
      field.insert(field.end(), o.field.begin(), o.field.end());
      if (r != nullptr && std::isfinite(off)) {
        s.worst.push_back({o.name, o.kind, o.path_verdict, r->truth, r->value, r->U});
        analytic.push_back(o.analytic_U_mm);
        simulated.push_back(o.monte_carlo_U_mm);
        error.push_back(off);
        truth.push_back(r->truth);
      }
    }
  }
  if (s.repeat_mm.size() > 1) s.repeat = typeOne(s.repeat_mm, kTolerance_mm);
  if (s.relay_mm.size() > 1) s.relay = typeOne(s.relay_mm, kTolerance_mm);
  if (grr.size() == kGrrParts * kGrrPlacements * kGrrRepeats)
    s.grr = anovaGrr(grr, kGrrParts, kGrrPlacements, kGrrRepeats, kTolerance_mm);
  if (truth.size() > 2) s.linearity = linearityOf(truth, error);
  s.budget = budgetCheck(analytic, simulated, error);
  s.field = fieldOf(field);
}

void addStill(const std::vector<std::pair<CaseId, StillOutcome>>& cases, GaugeSection& s) {
  std::vector<double> analytic;
  std::vector<double> simulated;
  std::vector<double> error;
  std::vector<double> truth;
  for (const auto& [id, o] : cases) {
    const Reading* r = readingOf(o, kLargestDrift);
    if (r == nullptr || !std::isfinite(r->value)) continue;
    if (id.study == Study::kStillRepeat) {
      s.drift_repeat_mm.push_back(r->value - r->truth);
      continue;
    }
    s.drift.push_back({o.name, FaultKind::kOffset, o.verdict, r->truth, r->value, r->U});
    analytic.push_back(o.analytic_U_mm);
    simulated.push_back(o.monte_carlo_U_mm);
    error.push_back(r->value - r->truth);
    truth.push_back(r->truth);
  }
  if (s.drift_repeat_mm.size() > 1) s.drift_repeat = typeOne(s.drift_repeat_mm, kTolerance_mm);
  if (truth.size() > 2) s.drift_linearity = linearityOf(truth, error);
  s.drift_budget = budgetCheck(analytic, simulated, error);
}

/// Whether anything is claimed of a quantity. In other worlds that is what a check judges by: RMS,
/// circularity, rounding and overshoot are shown for people. So is a peak: where a cut strays to, an
/// excursion tells.
bool isClaimed(std::string_view quantity, bool mismatch) {
  if (quantity == "peak of a cut") return false;
  if (!mismatch) return true;
  constexpr std::array<std::string_view, 4> kShown{"RMS", "circularity", "corner rounding",
                                                   "corner overshoot"};
  return std::ranges::none_of(kShown, [&](std::string_view shown) { return quantity.starts_with(shown); });
}

}  // namespace

Coverage coverageOf(const std::string& quantity, const std::vector<Named>& readings) {
  Coverage c;
  c.quantity = quantity;
  std::vector<double> errors;
  std::vector<double> widths;
  std::vector<std::pair<double, std::string>> misses;
  double squares = 0.0;
  for (const auto& [name, r] : readings) {
    if (!std::isfinite(r.value) || !std::isfinite(r.U) || !std::isfinite(r.truth)) {
      ++c.missing;
      continue;
    }
    const double error = r.value - r.truth;
    ++c.cases;
    if (std::abs(error) <= r.U) {
      ++c.hits;
    } else {
      misses.emplace_back(-std::abs(error) / r.U, name);
    }
    errors.push_back(error);
    widths.push_back(r.U);
    if (r.U > 0.0) {
      squares += 4.0 * error * error / (r.U * r.U);
      c.z_mean += 2.0 * error / r.U;
    }
  }
  if (c.cases == 0) return c;
  c.share = clopperPearson(c.hits, c.cases);
  c.error_mm = momentsOf(errors);
  c.U_median_mm = quantileOf(widths, 0.5);
  c.U_95_mm = quantileOf(widths, 0.95);
  c.U_most_mm = quantileOf(widths, 1.0);
  c.z_sigma = std::sqrt(squares / static_cast<double>(c.cases));
  c.z_mean /= static_cast<double>(c.cases);
  std::ranges::sort(misses);
  for (std::size_t i = 0; i < std::min<std::size_t>(5, misses.size()); ++i)
    c.worst.push_back(misses[i].second);
  return c;
}

GaugeSection sectionOf(const std::string& preset, const std::vector<std::pair<CaseId, KerfOutcome>>& kerf,
                       const std::vector<std::pair<CaseId, StillOutcome>>& still, bool mismatch) {
  GaugeSection s;
  s.preset = preset;
  s.mismatch = mismatch;
  std::vector<std::string> order;
  std::map<std::string, std::vector<Named>> by;
  for (const auto& [id, o] : kerf) {
    const bool verdict = id.study == Study::kBad || id.study == Study::kGood;
    if (!verdict && id.study != Study::kCoverage) continue;
    const bool counts = verdict || mismatch;
    const bool invalid = o.verdict == inspect::Verdict::kInvalid;
    s.of += counts ? 1 : 0;
    s.invalid += counts && invalid ? 1 : 0;
    // In another world a sheet may be one that nobody can measure; then the bench must say so.
    if (!(mismatch && invalid)) collect(o, order, by);
  }
  const std::size_t of_kerfs = order.size();
  for (const auto& [id, o] : still) {
    if (id.study == Study::kStill) collect(o, order, by);
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    s.coverage.push_back(coverageOf(order[i], by[order[i]]));
    s.coverage.back().two_sided = mismatch || i >= of_kerfs;
    s.coverage.back().claimed = isClaimed(order[i], mismatch);
  }
  for (const FaultKind kind : kFaultKinds) s.kinds.push_back(kindOf(kind, kerf));
  addKerf(kerf, s);
  addStill(still, s);
  return s;
}

}  // namespace kerfbench::gauge
