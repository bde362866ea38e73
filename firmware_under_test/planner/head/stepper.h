// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Place to command, in steps, for a stepper that is to stand at a place: with detent torque T_d and holding
/// torque T_h the rotor stands where T_h sin(N (u - q)) = T_d sin(4 N q), so that
///
///     u = q + asin(T_d / T_h sin(4 N q)) / N
///
/// with N teeth, and 4 N q a whole turn for each full step. Without detent, the place itself.
double againstDetent(double place_steps, const StepperMotors& motors);

/// Controller whose steps a stepper gets.
struct StepSource {
  double period_s{};  ///< Steps are counted in periods, and come evenly within one (engine.h); > 0.
  int ticks{};        ///< Ticks of a period.
  int most_steps{};   ///< Most steps in a period.
  double delay_s{};   ///< Delay of the rotor behind its steps.
};

/// Chooses the steps of each period so that the rotor itself, which swings at its own frequency with little
/// damping, runs as wanted.
///
/// Wanted places rounded to whole steps, period by period, leave a pattern that repeats with the part of a
/// step that a period has too much. Where that meets the rotor's own frequency, half a step becomes several.
/// This looks for the positions, each less than two steps from the wanted one, for which the sum of squares
/// of the rotor's distance from the wanted place a delay ago is least: the linear swing
/// q'' = w² (u - q) - 2 d w q', over all periods, by keeping the best few beginnings (M-algorithm; Anderson,
/// Mohan 1984). No step goes against the wanted direction, and an axis that rests stays at one step.
class StepChoice {
 public:
  /// @pre motors.resonance_hz > 0
  StepChoice(const StepperMotors& motors, const StepSource& source);

  /// Positions at the end of each period. @param wanted Wanted positions at the end of each period, steps.
  /// @param from Position at which the axis has come to rest before the first. The last is the nearest to
  /// what is wanted there.
  [[nodiscard]] std::vector<int> along(std::span<const double> wanted, int from) const;

 private:
  /// Places within a period at which the rotor is held against what is wanted.
  static constexpr std::size_t kParts = 4;
  struct Swing {  ///< Distance of the rotor from its command, steps, and what turns into it.
    double re{}, im{};
  };
  /// What the steps of a period have done to the swing and to the command by the end of each of its parts.
  struct Kick {
    Swing swing{};
    int steps{};
  };
  struct Branch {
    double cost{};
    Swing swing{};
    int at{};
    std::size_t node{};
  };
  struct Search;

  [[nodiscard]] static Swing times(const Swing& a, const Swing& b);
  [[nodiscard]] Swing after(const Swing& swing, double time_s) const;
  [[nodiscard]] std::array<Kick, kParts> kicksOf(int count) const;
  void extend(Search& search, const Branch& branch, std::span<const double> wanted, std::size_t k) const;
  [[nodiscard]] bool allowed(const Branch& branch, std::span<const double> wanted, std::size_t k,
                             int to) const;
  /// Runs the rotor of a branch through a period at whose end it is commanded to a place.
  [[nodiscard]] Branch through(const Branch& branch, std::span<const double> wanted, std::size_t k,
                               int to) const;

  StepSource source_;
  double decay_;                                 ///< 1/s
  double frequency_;                             ///< Damped, rad/s.
  Swing part_{};                                 ///< Factor of a swing through a part of a period.
  std::vector<std::array<Kick, kParts>> kicks_;  ///< Index: number of steps, all forwards.
};

}  // namespace kerfbench::planner
