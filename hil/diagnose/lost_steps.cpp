// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/lost_steps.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace kerfbench::diagnose {
namespace {

constexpr std::size_t kMostTimes = 40;
constexpr double kFewestRows = 4;

struct Moment {
  double time_s{};
  Eigen::Vector2d moved_mm{0, 0};  ///< Way of the head over the gap.
};

/// Where the readings of a stage leave the widest gaps in time, and evenly between.
std::vector<Moment> momentsOf(const std::vector<Row>& rows, Stage stage) {
  std::vector<const Row*> sorted;
  for (const Row& row : rows)
    if (row.stage == stage && row.head.known()) sorted.push_back(&row);
  std::ranges::sort(sorted, {}, [](const Row* row) { return row->head.time_s; });
  std::vector<Moment> moments;
  std::vector<std::size_t> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i) gaps.push_back(i);
  std::ranges::stable_sort(gaps, std::greater<>(), [&](std::size_t i) {
    return sorted[i]->head.time_s - sorted[i - 1]->head.time_s;
  });
  if (gaps.size() > kMostTimes / 2) gaps.resize(kMostTimes / 2);
  for (std::size_t i = 1; i < kMostTimes / 2 && sorted.size() > kMostTimes; ++i)
    gaps.push_back(i * sorted.size() / (kMostTimes / 2));
  std::ranges::sort(gaps);
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());
  for (const std::size_t i : gaps) {
    if (static_cast<double>(i) < kFewestRows || static_cast<double>(sorted.size() - i) < kFewestRows)
      continue;
    const Row& before = *sorted[i - 1];
    const Row& after = *sorted[i];
    if (!(after.head.time_s > before.head.time_s)) continue;
    moments.push_back({0.5 * (before.head.time_s + after.head.time_s), after.head.p_mm - before.head.p_mm});
  }
  return moments;
}

std::string axisName(int axis) { return axis == 0 ? "X" : "Y"; }

/// A size > 0 is of pulses that were lost, one < 0 of pulses that came twice.
KnownCause ofPulses(const Evidence& evidence, int axis, const Moment& moment, const std::string& key) {
  const double step_mm = evidence.machine.step_mm[axis];
  KnownCause cause;
  cause.key = kPulsesLost;
  cause.hypothesis = {cause.key, {key}};
  cause.size_of = {key};
  const double forward = moment.moved_mm[axis] >= 0.0 ? 1.0 : -1.0;
  cause.factor = -forward / (step_mm > 0.0 ? step_mm : 1.0);
  cause.unit = step_mm > 0.0 ? "steps" : "mm";
  cause.what = [=](const std::vector<double>& s, double U) {
    return fmt::format("About {:.3f} s {} pulses of {} {}", moment.time_s, withU(std::abs(s[0]), U),
                       axisName(axis), s[0] < 0.0 ? "came twice" : "were lost");
  };
  cause.advice = [=](const std::vector<double>&) {
    return std::string(
        "from then on all lines lie aside: look at what the release does then (UART, interrupts)");
  };
  return cause;
}

KnownCause ofHead(const Evidence& evidence, int axis, const Moment& moment, const std::string& key) {
  const bool is_stepper = evidence.machine.full_step_pulses[axis] > 0.0;
  KnownCause cause;
  cause.key = is_stepper ? kPulledOut : "axis_slipped";
  cause.hypothesis = {cause.key, {key}};
  cause.size_of = {key};
  cause.unit = "mm";
  cause.what = [=](const std::vector<double>& s, double U) {
    return fmt::format("About {:.3f} s {} stayed {} mm behind its pulses for good", moment.time_s,
                       axisName(axis), withU(std::abs(s[0]), U));
  };
  cause.advice = [=](const std::vector<double>&) {
    return std::string(
        is_stepper ? "the stepper was pulled out: ask for less acceleration there, or give it more current"
                   : "the axis slipped, or its drive took pulses the wrong way: check DIR's times, couplings "
                     "and belts");
  };
  return cause;
}

}  // namespace

std::vector<LostSteps> lostSteps(const Evidence& evidence, const std::vector<Row>& rows) {
  std::vector<LostSteps> list;
  for (const Stage stage : {Stage::kController, Stage::kMachine}) {
    const std::vector<Moment> moments = momentsOf(rows, stage);
    for (std::size_t i = 0; i < moments.size(); ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        Signature signature = stepAt(stage, axis, moments[i].time_s);
        signature.key += fmt::format("@{}", i);
        KnownCause cause = stage == Stage::kMachine ? ofHead(evidence, axis, moments[i], signature.key)
                                                    : ofPulses(evidence, axis, moments[i], signature.key);
        list.push_back({std::move(signature), std::move(cause)});
      }
    }
  }
  return list;
}

std::vector<KnownCause> leakingPulses(const Evidence& evidence) {
  std::vector<KnownCause> list;
  double most_mm[2] = {0.0, 0.0};
  for (const LineReading& line : evidence.lines)
    for (int axis = 0; axis < 2; ++axis) most_mm[axis] = std::max(most_mm[axis], line.head.forward_mm[axis]);
  for (int axis = 0; axis < 2; ++axis) {
    const double step_mm = evidence.machine.step_mm[axis];
    if (!(step_mm > 0.0)) continue;
    for (const bool forward : {true, false}) {
      const std::string key = fmt::format("leak_{}_{}", axis == 0 ? "x" : "y", forward ? "forward" : "back");
      KnownCause cause;
      cause.key = kPulsesLost;
      cause.hypothesis = {cause.key, {key}};
      cause.size_of = {key};
      cause.factor = (forward ? -1.0 : 1.0) * most_mm[axis] / step_mm;
      cause.unit = "steps";
      cause.what = [=](const std::vector<double>& s, double U) {
        return fmt::format("Now and then, {} in all, pulses of {} that lead {} {}", withU(std::abs(s[0]), U),
                           axisName(axis), forward ? "forwards" : "backwards",
                           s[0] < 0.0 ? "come twice" : "get lost");
      };
      cause.advice = [](const std::vector<double>&) {
        return std::string(
            "lines lie farther aside the later they are cut: look at what shares the interrupt (UART, log)");
      };
      list.push_back(std::move(cause));
    }
  }
  return list;
}

}  // namespace kerfbench::diagnose
