// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/gauge.h"

#include <algorithm>
#include <mutex>

#include "hil/base/parallel.h"

namespace kerfbench::gauge {
namespace {

std::vector<CaseId> planOf(const GaugeOptions& options) {
  std::vector<CaseId> plan;
  const std::size_t presets = std::max<std::size_t>(options.presets.size(), 1);
  for (std::size_t p = 0; p < options.presets.size(); ++p) {
    const auto add = [&](Study study, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) plan.push_back({options.presets[p], study, i});
    };
    // What does not divide evenly goes to the first ones.
    const auto part = [&](std::size_t all) { return all / presets + (p < all % presets ? 1 : 0); };
    add(Study::kBad, part(options.bad));
    add(Study::kGood, part(options.good));
    add(Study::kCoverage, options.coverage);
    add(Study::kRepeat, options.repeats);
    add(Study::kRelay, options.repeats);
    if (options.grr) add(Study::kGrr, kGrrParts * kGrrPlacements * kGrrRepeats);
    add(Study::kStill, options.still);
    add(Study::kStillRepeat, options.still_repeats);
  }
  return plan;
}

std::string nameOf(twin::Preset preset) {
  return preset == twin::Preset::kStatic ? "static" : preset == twin::Preset::kDynamic ? "dynamic" : "ideal";
}

}  // namespace

bool GaugeResult::holds() const {
  return std::ranges::none_of(claims, [](const Claim& c) { return c.state == Claim::State::kFails; });
}

GaugeResult runGauge(const GaugeSetup& setup, const GaugeOptions& options, const GaugeProgress& progress) {
  const KerfStudy kerf_study(setup);
  const StillStudy still_study(setup);
  const std::vector<CaseId> plan = planOf(options);
  std::vector<KerfOutcome> kerf(plan.size());
  std::vector<StillOutcome> still(plan.size());
  std::mutex mutex;
  std::size_t done = 0;
  base::forEachIndex(plan.size(), options.jobs, [&](std::size_t i) {
    if (watchesSpot(plan[i].study)) {
      still[i] = still_study.run(stillCase(plan[i], options.seed));
    } else {
      kerf[i] = kerf_study.run(kerfCase(plan[i], options.seed, kerf_study));
    }
    const std::scoped_lock lock(mutex);
    progress(++done, plan.size());
  });

  GaugeResult result;
  for (const twin::Preset preset : options.presets) {
    std::vector<std::pair<CaseId, KerfOutcome>> kerf_cases;
    std::vector<std::pair<CaseId, StillOutcome>> still_cases;
    for (std::size_t i = 0; i < plan.size(); ++i) {
      if (plan[i].preset != preset) continue;
      if (watchesSpot(plan[i].study)) {
        still_cases.emplace_back(plan[i], std::move(still[i]));
      } else {
        kerf_cases.emplace_back(plan[i], std::move(kerf[i]));
      }
    }
    result.kerf_cases += kerf_cases.size();
    result.still_cases += still_cases.size();
    result.sections.push_back(sectionOf(nameOf(preset), kerf_cases, still_cases, setup.mismatch));
    for (Claim& claim : claimsOf(result.sections.back())) result.claims.push_back(std::move(claim));
  }
  return result;
}

}  // namespace kerfbench::gauge
