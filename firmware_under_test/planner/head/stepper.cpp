// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/head/stepper.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace kerfbench::planner {
namespace {

/// Beginnings that are kept; with 64 in place of 16 no axis came out better by more than 0.1 step.
constexpr std::size_t kKept = 16;
/// Farthest position from the wanted one, steps.
constexpr double kReach = 1.5;
/// Change of a wanted position, steps in a period, below which the axis rests: rounding of numbers.
constexpr double kRests = 1e-6;

/// Wanted position at a time after the first, in periods, straight between the ends of two.
double wantedAt(std::span<const double> wanted, double at) {
  if (at <= 0.0) return wanted.front();
  const auto before = static_cast<std::size_t>(at);
  if (before + 1 >= wanted.size()) return wanted.back();
  const double share = at - static_cast<double>(before);
  return wanted[before] + share * (wanted[before + 1] - wanted[before]);
}

}  // namespace

double againstDetent(double place_steps, const StepperMotors& motors) {
  if (motors.full_step_pulses <= 0.0 || motors.detent_share == 0.0) return place_steps;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double pull = motors.detent_share * std::sin(kTurn * place_steps / motors.full_step_pulses);
  return place_steps + std::asin(pull) * 2.0 / std::numbers::pi * motors.full_step_pulses;
}

StepChoice::Swing StepChoice::times(const Swing& a, const Swing& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

struct StepChoice::Search {
  struct Node {
    std::size_t parent{};
    int at{};
  };
  std::vector<Branch> kept, tried;
  std::vector<Node> nodes;
};

StepChoice::StepChoice(const StepperMotors& motors, const StepSource& source)
    : source_(source),
      decay_(motors.resonance_damping * 2.0 * std::numbers::pi * motors.resonance_hz),
      frequency_(2.0 * std::numbers::pi * motors.resonance_hz *
                 std::sqrt(1.0 - motors.resonance_damping * motors.resonance_damping)),
      part_(after({1.0, 0.0}, source.period_s / kParts)) {
  for (int count = 0; count <= source.most_steps; ++count) kicks_.push_back(kicksOf(count));
}

StepChoice::Swing StepChoice::after(const Swing& swing, double time_s) const {
  const double size = std::exp(-decay_ * time_s);
  return times(swing, {size * std::cos(frequency_ * time_s), size * std::sin(frequency_ * time_s)});
}

std::array<StepChoice::Kick, StepChoice::kParts> StepChoice::kicksOf(int count) const {
  std::array<Kick, kParts> kicks;
  for (std::size_t part = 0; part < kParts; ++part) {
    const double end_s = source_.period_s * static_cast<double>(part + 1) / kParts;
    for (int i = 0; i < count; ++i) {
      // Step i of m comes in the tick in which its share (i + 1/2) / m of the period is over.
      const double tick = std::ceil((i + 0.5) / count * source_.ticks);
      const double at_s = tick / source_.ticks * source_.period_s;
      if (at_s > end_s || at_s <= end_s - source_.period_s / kParts) continue;
      // The command jumps and the rotor stays: its distance changes by a step, its speed does not.
      const Swing by = after({-1.0, decay_ / frequency_}, end_s - at_s);
      kicks[part].swing.re += by.re;
      kicks[part].swing.im += by.im;
      ++kicks[part].steps;
    }
  }
  return kicks;
}

bool StepChoice::allowed(const Branch& branch, std::span<const double> wanted, std::size_t k, int to) const {
  const int count = to - branch.at;
  if (std::abs(count) > source_.most_steps) return false;
  const double way = k == 0 ? wanted[0] - branch.at : wanted[k] - wanted[k - 1];
  if (std::abs(way) < kRests)
    return count == 0 || std::abs(wanted[k] - to) < std::abs(wanted[k] - branch.at) - kRests;
  return count == 0 || (count > 0) == (way > 0.0);
}

StepChoice::Branch StepChoice::through(const Branch& branch, std::span<const double> wanted, std::size_t k,
                                       int to) const {
  Branch next = branch;
  const int count = to - branch.at;
  const int way = count > 0 ? 1 : -1;
  const auto& kicks = kicks_[std::min(static_cast<std::size_t>(std::abs(count)), kicks_.size() - 1)];
  for (std::size_t part = 0; part < kParts; ++part) {
    next.swing = times(next.swing, part_);
    next.swing.re += way * kicks[part].swing.re;
    next.swing.im += way * kicks[part].swing.im;
    next.at += way * kicks[part].steps;
    const double over = static_cast<double>(part + 1) / kParts - source_.delay_s / source_.period_s;
    const double off = next.at + next.swing.re - wantedAt(wanted, static_cast<double>(k) + over - 1.0);
    next.cost += off * off;
  }
  next.at = to;
  return next;
}

void StepChoice::extend(Search& search, const Branch& branch, std::span<const double> wanted,
                        std::size_t k) const {
  const auto add = [&](int to) {
    Branch next = through(branch, wanted, k, to);
    next.node = search.nodes.size();
    search.nodes.push_back({branch.node, to});
    search.tried.push_back(next);
  };
  if (k + 1 == wanted.size()) return add(static_cast<int>(std::lround(wanted[k])));
  const std::size_t before = search.tried.size();
  const int first = static_cast<int>(std::ceil(wanted[k] - kReach));
  const int last = static_cast<int>(std::floor(wanted[k] + kReach));
  for (int to = first; to <= last; ++to) {
    if (allowed(branch, wanted, k, to)) add(to);
  }
  // Too fast for the controller, which the caller refuses.
  if (search.tried.size() == before) add(static_cast<int>(std::lround(wanted[k])));
}

std::vector<int> StepChoice::along(std::span<const double> wanted, int from) const {
  Search search;
  search.nodes.push_back({0, from});
  search.kept.push_back({0.0, {}, from, 0});
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    search.tried.clear();
    for (const Branch& branch : search.kept) extend(search, branch, wanted, k);
    std::stable_sort(search.tried.begin(), search.tried.end(),
                     [](const Branch& a, const Branch& b) { return a.cost < b.cost; });
    search.tried.resize(std::min(search.tried.size(), kKept));
    search.kept.swap(search.tried);
  }
  std::vector<int> positions(wanted.size());
  std::size_t node = search.kept.front().node;
  for (std::size_t k = wanted.size(); k-- > 0;) {
    positions[k] = search.nodes[node].at;
    node = search.nodes[node].parent;
  }
  return positions;
}

}  // namespace kerfbench::planner
