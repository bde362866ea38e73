// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/observation.h"

#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>

#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

/// All sightings of one number as one, or nothing if they are not of one place.
std::optional<SeenMark> mergedMark(const std::vector<SeenMark>& sightings, double same_sigmas) {
  SeenMark merged = sightings.front();
  for (std::size_t i = 1; i < sightings.size(); ++i) {
    const SeenMark& next = sightings[i];
    const Eigen::Vector2d apart_mm = next.p_mm - merged.p_mm;
    const Eigen::Matrix2d total = next.covariance_mm2 + merged.covariance_mm2;
    if (distance2(apart_mm, total) > same_sigmas * same_sigmas) return std::nullopt;
    const Eigen::Matrix2d gain = merged.covariance_mm2 * total.inverse();
    merged.p_mm += gain * apart_mm;
    merged.covariance_mm2 = gain * next.covariance_mm2;
    merged.covariance_mm2 = 0.5 * (merged.covariance_mm2 + merged.covariance_mm2.transpose().eval());
  }
  return merged;
}

using Sightings = std::map<int, std::vector<SeenMark>>;

Sightings sorted(std::span<const SeenMark> seen, std::string& faults) {
  Sightings by_id;
  for (const SeenMark& mark : seen) {
    if (!mark.p_mm.allFinite() || !isCovariance(mark.covariance_mm2)) {
      faults += fmt::format("mark {} as found is not finite or has no positive covariance\n", mark.id);
    } else {
      by_id[mark.id].push_back(mark);
    }
  }
  return by_id;
}

void refuseTooMany(const Pairing& pairing, std::size_t aimed, std::size_t seen, const PairingLimits& limits,
                   std::string& faults) {
  const auto most = [](double share, std::size_t of) { return share * static_cast<double>(of); };
  if (static_cast<double>(pairing.missing.size()) > most(limits.missing_share, aimed)) {
    faults += fmt::format("{} of {} marks are missing, more than {:.0f} %: {}\n", pairing.missing.size(),
                          aimed, 100.0 * limits.missing_share, fmt::join(pairing.missing, ", "));
  }
  const std::size_t wrong = pairing.doubled.size() + pairing.unknown.size();
  if (static_cast<double>(wrong) > most(limits.false_share, seen)) {
    faults += fmt::format(
        "of {} marks found, {} numbers are at several places ({}) and {} are not of the job ({}): more than "
        "{:.0f} %\n",
        seen, pairing.doubled.size(), fmt::join(pairing.doubled, ", "), pairing.unknown.size(),
        fmt::join(pairing.unknown, ", "), 100.0 * limits.false_share);
  }
}

}  // namespace

bool isMeasured(const HeadObservation& observation) {
  return observation.aim_W_mm.allFinite() && observation.measured_W_mm.allFinite() &&
         isCovariance(observation.covariance_mm2) &&
         (!observation.shared || observation.shared->modes_mm.allFinite());
}

Pairing pairMarks(std::span<const AimedMark> aimed, std::span<const SeenMark> seen,
                  const PairingLimits& limits) {
  std::string faults;
  Sightings by_id = sorted(seen, faults);
  Pairing pairing;
  std::set<int> of_job;
  for (const AimedMark& mark : aimed) {
    if (!of_job.insert(mark.id).second) faults += fmt::format("mark {} is twice in the job\n", mark.id);
    if (!mark.aim_W_mm.allFinite()) faults += fmt::format("the aim of mark {} is not finite\n", mark.id);
    const auto found = by_id.find(mark.id);
    if (found == by_id.end()) {
      pairing.missing.push_back(mark.id);
      continue;
    }
    const auto merged = mergedMark(found->second, limits.same_sigmas);
    if (!merged) {
      pairing.doubled.push_back(mark.id);
      continue;
    }
    if (found->second.size() > 1) pairing.merged.push_back(mark.id);
    pairing.observations.push_back(
        {mark.id, mark.aim_W_mm, merged->p_mm, merged->covariance_mm2, std::nullopt});
  }
  for (const auto& [id, sightings] : by_id) {
    if (!of_job.contains(id)) pairing.unknown.push_back(id);
  }
  refuseTooMany(pairing, aimed.size(), seen.size(), limits, faults);
  if (!faults.empty()) throw HeadCalibrationError(faults.substr(0, faults.size() - 1));
  return pairing;
}

}  // namespace kerfbench::calibrate
