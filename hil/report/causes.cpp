// SPDX-License-Identifier: Apache-2.0
#include "hil/report/causes.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>

namespace kerfbench::report {
namespace {

using Checks = std::vector<const inspect::Check*>;

/// Controller, pins and beam.
std::vector<CheckFacts> factsOfMachine() {
  return {
      {"finish", "The controller did not finish the job", {}},
      {"account", "The controller is not where it says", {}},
      {"pulse_timing", "Pulses break the drives' timing", {}},
      {"interlock", "The laser stayed on behind an open guard", {}},
      {"safe_state", "The laser did not go off in time", {}},
      {"safe_stop", "The axes did not come to rest in time", {}},
      {"safe_report", "The controller did not say why it stopped", {}},
      {"belt", "The sheet in the pictures and the belt's encoder disagree", {}},
      {"gate_lag", "The laser comes on too late or too early for the beam", {}},
      {"laser_gate", "The laser shines while its gate is off", {}},
      {"spot_seen", "The spot was not seen though the laser's gate was open", {}},
      {"stillness_x",
       "The beam drifts against the moving sheet, along x",
       {"pulse_timing", "account", "belt"}},
      {"stillness_peak",
       "The beam strays from its place on the moving sheet, along x",
       {"stillness_x", "pulse_timing", "account", "belt"}},
      {"spot_path",
       "The spot was off the dieline while cutting",
       {"pulse_timing", "account", "stillness_x", "stillness_peak"}},
      {"line_energy", "Marks got another energy per length than was ordered", {"laser_gate"}},
      {"repeat", "A line was cut more than once", {"spot_path"}},
      {"dwell", "The beam rested while the laser worked", {"finish", "gate_lag", "laser_gate"}},
  };
}

/// What was cut.
std::vector<CheckFacts> factsOfCut() {
  return {
      {"path",
       "The cut lies off the dieline",
       {"pulse_timing", "account", "stillness_x", "stillness_peak", "spot_path"}},
      {"edge",
       "The wanted piece's edge lies off the dieline",
       {"pulse_timing", "account", "stillness_x", "stillness_peak", "spot_path"}},
      {"laser_timing",
       "Lines are not burnt from their first to their last point",
       {"finish", "gate_lag", "laser_gate", "line_energy", "stillness_x", "stillness_peak", "spot_path",
        "path"}},
      {"joints",
       "Corners, line ends or closures lie off the dieline",
       {"pulse_timing", "account", "stillness_x", "stillness_peak", "spot_path", "path", "edge", "gate_lag",
        "laser_gate", "laser_timing", "dwell"}},
      {"coverage",
       "Lines are not cut over their whole length",
       {"finish", "gate_lag", "laser_gate", "laser_timing", "stillness_x", "stillness_peak", "spot_path",
        "path", "edge", "line_energy"}},
      {"bridges",
       "What was cut does not come off",
       {"finish", "coverage", "laser_gate", "spot_path", "line_energy"}},
      {"stray",
       "Something is burnt beside the dieline",
       {"finish", "laser_gate", "stillness_x", "stillness_peak", "spot_path", "path", "edge", "dwell"}},
      {"kerf_width",
       "Kerfs of one process are not equally wide",
       {"repeat", "dwell", "line_energy", "stillness_x", "stillness_peak"}},
      {"ordered_width", "Cuts are not as wide as ordered", {"repeat", "line_energy"}},
      {"depth", "A crease or half-cut is cut through", {"repeat", "dwell", "line_energy"}},
      {"ordered_depth",
       "Creases or half-cuts are not as deep as ordered",
       {"repeat", "dwell", "line_energy", "depth"}},
      {"even_depth", "Creases or half-cuts are not evenly deep", {"repeat", "dwell", "line_energy", "depth"}},
      {"perforation",
       "Perforations have not the cuts and bridges ordered",
       {"gate_lag", "laser_gate", "spot_path", "line_energy"}},
  };
}

const CheckFacts* factsOf(std::string_view name) {
  const auto found = std::ranges::find(checkFacts(), name, &CheckFacts::name);
  return found == checkFacts().end() ? nullptr : &*found;
}

/// Place in checkFacts(); those that are not known come last.
std::size_t rankOf(std::string_view name) {
  return static_cast<std::size_t>(
      std::distance(checkFacts().begin(), std::ranges::find(checkFacts(), name, &CheckFacts::name)));
}

Checks thoseOf(const std::vector<inspect::Check>& checks, inspect::Verdict verdict) {
  Checks found;
  for (const inspect::Check& check : checks)
    if (check.verdict == verdict) found.push_back(&check);
  return found;
}

/// The check that `check` follows; null if it fails by itself.
const inspect::Check* leaderOf(const inspect::Check& check, const Checks& all) {
  const CheckFacts* facts = factsOf(check.name);
  if (facts == nullptr) return nullptr;
  for (const std::string_view leader : facts->follows) {
    const auto found = std::ranges::find(all, leader, &inspect::Check::name);
    if (found != all.end()) return *found;
  }
  return nullptr;
}

}  // namespace

const std::vector<CheckFacts>& checkFacts() {
  static const std::vector<CheckFacts> kFacts = [] {
    std::vector<CheckFacts> all = factsOfMachine();
    std::ranges::move(factsOfCut(), std::back_inserter(all));
    return all;
  }();
  return kFacts;
}

std::string failingPhrase(std::string_view name) {
  const CheckFacts* facts = factsOf(name);
  return std::string(facts == nullptr ? name : facts->failing);
}

std::vector<FailureGroup> failureGroups(const std::vector<inspect::Check>& checks, inspect::Verdict verdict) {
  Checks all = thoseOf(checks, verdict);
  std::ranges::stable_sort(all, {}, [](const inspect::Check* c) { return rankOf(c->name); });
  const Checks failing = thoseOf(checks, inspect::Verdict::kFail);
  std::vector<FailureGroup> groups;
  std::map<const inspect::Check*, std::size_t> group_of;
  for (const inspect::Check* check : all) {
    // What a failing check brings along is told there.
    if (verdict != inspect::Verdict::kFail && leaderOf(*check, failing) != nullptr) continue;
    // Leaders come before their followers in checkFacts(), so that theirs is known.
    const inspect::Check* leader = leaderOf(*check, all);
    if (leader != nullptr && group_of.contains(leader)) {
      group_of[check] = group_of.at(leader);
      groups[group_of[check]].followers.push_back(check);
    } else {
      group_of[check] = groups.size();
      groups.push_back({check, {}});
    }
  }
  if (verdict == inspect::Verdict::kFail) {
    for (const inspect::Check& check : checks) {
      if (check.verdict != inspect::Verdict::kNotProven && check.verdict != inspect::Verdict::kInvalid)
        continue;
      if (const inspect::Check* leader = leaderOf(check, failing); leader != nullptr)
        groups[group_of.at(leader)].followers.push_back(&check);
    }
  }
  std::ranges::stable_sort(groups, std::ranges::greater(),
                           [](const FailureGroup& g) { return g.followers.size(); });
  return groups;
}

}  // namespace kerfbench::report
