// SPDX-License-Identifier: Apache-2.0
// Claims of the instrument against what was found.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/gauge/gauge.h"

namespace kerfbench::gauge {
namespace {

constexpr double kMostU_mm = 0.005;
constexpr double kMostSigma_mm = 0.005 / 3.0;
constexpr double kMostGrr = 10.0;
constexpr double kLeastCg = 1.67;
constexpr double kLeastNdc = 10.0;
constexpr double kBudgetAgrees = 0.10;
constexpr double kCoverageLow = 0.94;
constexpr double kCoverageHigh = 0.968;
constexpr std::size_t kCoverageCases = 1000;  ///< From so many on the share itself is held to the limits.
constexpr double kMostNotProven = 0.01;
constexpr double kMostUnmeasured = 0.02;  ///< Board so dark and grainy that ink, or a crease, cannot be seen.

class Claims {
 public:
  explicit Claims(std::string preset) : preset_(std::move(preset)) {}

  void most(const std::string& what, double is, double limit, const char* unit, double scale = 1.0) {
    add(what, fmt::format("{:.3g}{}", scale * is, unit), fmt::format("≤ {:.3g}{}", scale * limit, unit),
        is <= limit);
  }
  void least(const std::string& what, double is, double limit) {
    add(what, fmt::format("{:.3g}", is), fmt::format("≥ {:.3g}", limit), is >= limit);
  }
  void add(const std::string& what, std::string measured, std::string limit, bool holds) {
    add(what, std::move(measured), std::move(limit), holds ? Claim::State::kHolds : Claim::State::kFails);
  }
  void add(const std::string& what, std::string measured, std::string limit, Claim::State state) {
    claims_.push_back({preset_, what, std::move(measured), std::move(limit), state});
  }
  std::vector<Claim> take() { return std::move(claims_); }

 private:
  std::string preset_;
  std::vector<Claim> claims_;
};

std::size_t countOf(const std::map<inspect::Verdict, std::size_t>& verdicts, inspect::Verdict verdict) {
  const auto at = verdicts.find(verdict);
  return at == verdicts.end() ? 0 : at->second;
}

void claimType1(const char* name, const std::optional<TypeOne>& t, Claims& claims) {
  if (!t) return;
  claims.most(fmt::format("{}: σ of repeats", name), t->error.sigma, kMostSigma_mm, " µm", 1e3);
  claims.least(fmt::format("{}: Cg", name), t->cg, kLeastCg);
  claims.least(fmt::format("{}: Cgk", name), t->cgk, kLeastCg);
}

double mostUnmeasured(std::size_t all, bool mismatch) {
  return mismatch ? kMostUnmeasured * static_cast<double>(all) : 0.0;
}

std::string mostUnmeasuredText(bool mismatch) {
  return mismatch ? fmt::format("≤ {:g} %", 100.0 * kMostUnmeasured) : "0";
}

void claimCoverage(const Coverage& c, bool mismatch, Claims& claims) {
  const double most = c.two_sided ? kCoverageHigh : 1.0;
  if (c.cases == 0 || !c.claimed) return;
  const double share = static_cast<double>(c.hits) / static_cast<double>(c.cases);
  Claim::State state = Claim::State::kHolds;
  if (c.cases >= kCoverageCases) {
    if (share < kCoverageLow || share > most) state = Claim::State::kFails;
  } else {
    // Fewer cannot show it; they can show the contrary.
    state = c.share.high < kCoverageLow || c.share.low > most ? Claim::State::kFails : Claim::State::kOpen;
  }
  claims.add(fmt::format("95 % intervals hold the truth: {}", c.quantity),
             fmt::format("{:.1f} % of {} ({:.1f} … {:.1f})", 100.0 * share, c.cases, 100.0 * c.share.low,
                         100.0 * c.share.high),
             c.two_sided ? "94 … 96.8 %" : "≥ 94 %", state);
  if (c.missing == 0) return;
  const std::size_t all = c.cases + c.missing;
  claims.add(fmt::format("measured at all: {}", c.quantity), fmt::format("{} of {} missing", c.missing, all),
             mostUnmeasuredText(mismatch), static_cast<double>(c.missing) <= mostUnmeasured(all, mismatch));
}

/// Whether so few of all are NOT PROVEN. Few cases cannot show it; they can show the contrary.
Claim::State rarely(std::size_t open, std::size_t all) {
  if (all < kCoverageCases)
    return clopperPearson(open, all).low > kMostNotProven ? Claim::State::kFails : Claim::State::kOpen;
  const bool holds = static_cast<double>(open) <= kMostNotProven * static_cast<double>(all);
  return holds ? Claim::State::kHolds : Claim::State::kFails;
}

void claimVerdicts(const GaugeSection& s, Claims& claims) {
  std::size_t good = 0;
  for (const auto& [verdict, count] : s.good) good += count;
  for (const KindResult& k : s.kinds) {
    std::size_t of_kind = 0;
    for (const auto& [verdict, count] : k.bad) of_kind += count;
    if (of_kind == 0) continue;
    const std::size_t passed = countOf(k.bad, inspect::Verdict::kPass);
    claims.add(fmt::format("bad cuts that PASS: {}", faultName(k.kind)),
               fmt::format("{} of {}", passed, of_kind), "0", passed == 0);
  }
  if (good > 0) {
    const std::size_t failed = countOf(s.good, inspect::Verdict::kFail);
    const std::size_t open = countOf(s.good, inspect::Verdict::kNotProven);
    claims.add("good cuts that FAIL", fmt::format("{} of {}", failed, good), "0", failed == 0);
    // Where radius and light are hardly known, how many are is what U costs, and no claim.
    if (!s.mismatch)
      claims.add("good cuts NOT PROVEN", fmt::format("{} of {}", open, good), "≤ 1 %", rarely(open, good));
  }
  if (s.of > 0)
    claims.add("cuts that could not be measured (INVALID)", fmt::format("{} of {}", s.invalid, s.of),
               mostUnmeasuredText(s.mismatch),
               static_cast<double>(s.invalid) <= mostUnmeasured(s.of, s.mismatch));
}

}  // namespace

std::vector<Claim> claimsOf(const GaugeSection& s) {
  Claims claims(s.preset);
  for (const Coverage& c : s.coverage) {
    const bool decides = c.quantity == "worst of an entity" || c.quantity == "largest drift of all cuts";
    if (decides && c.cases > 0)
      claims.most(fmt::format("U (k = 2) of 95 % of cases: {}", c.quantity), c.U_95_mm, kMostU_mm, " µm",
                  1e3);
  }
  claimType1("worst deviation, as it lies", s.repeat, claims);
  claimType1("worst deviation, laid anew", s.relay, claims);
  claimType1("largest drift", s.drift_repeat, claims);
  if (s.grr) {
    claims.most("%GRR of the tolerance", s.grr->percent_of_tolerance, kMostGrr, " %");
    claims.least("ndc", s.grr->ndc, kLeastNdc);
  }
  if (s.budget.cases > 0)
    claims.most("worst deviation: budget and Monte-Carlo differ, 95 % of cases", s.budget.p95_departure,
                kBudgetAgrees, " %", 100.0);
  if (s.drift_budget.cases > 0)
    claims.most("largest drift: budget and Monte-Carlo differ, 95 % of cases", s.drift_budget.p95_departure,
                kBudgetAgrees, " %", 100.0);
  for (const Coverage& c : s.coverage) claimCoverage(c, s.mismatch, claims);
  claimVerdicts(s, claims);
  return claims.take();
}

}  // namespace kerfbench::gauge
