// SPDX-License-Identifier: Apache-2.0
// Input of the integrator for a train of pulses: its mean over the step, its edges, or a sample.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/motion.h"
#include "tests/validation/support/svg.h"
#include "tests/validation/support/twin_eight.h"
#include "twin/drive/pulse_command.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::validation {
namespace {

using Edges = std::vector<twin::StepEdge>;
using Trains = std::array<Edges, EightJoints::kDrives>;

// One pulse: belt and gantry 12.5 um, stepper 1/16 of 1.8 degrees, galvo 12.5 urad.
constexpr EightJoints::Command kPulse{12.5e-6 / 0.03, 12.5e-6, 12.5e-6, 1.9634954084936207e-3, 12.5e-6};
constexpr double kLook_s = 100e-6;
constexpr double kEdgeSlack_s = 1e-9;  // Rounding of edges on the grid.

Trains trainsOver(double end_s) {
  Trains trains;
  for (std::size_t i = 0; i < trains.size(); ++i) {
    trains[i] = pulsesFor([i](double time_s) { return EightJoints::slow(time_s)[i]; }, kPulse[i], end_s);
  }
  return trains;
}

/// Counts the edges up to a time.
class Staircase {
 public:
  explicit Staircase(const Trains& trains) : trains_(trains) {}
  const EightJoints::Command& upTo(double time_s) {
    for (std::size_t i = 0; i < trains_.size(); ++i) {
      while (next_[i] < trains_[i].size() && trains_[i][next_[i]].time_s < time_s + kEdgeSlack_s) {
        count_[i] += trains_[i][next_[i]++].direction;
      }
      command_[i] = static_cast<double>(count_[i]) * kPulse[i];
    }
    return command_;
  }
  /// Next edge of any train; infinity if there is none.
  [[nodiscard]] double nextEdge_s() const {
    double next_s = INFINITY;
    for (std::size_t i = 0; i < trains_.size(); ++i) {
      if (next_[i] < trains_[i].size()) next_s = std::min(next_s, trains_[i][next_[i]].time_s);
    }
    return next_s;
  }

 private:
  const Trains& trains_;
  std::array<std::size_t, EightJoints::kDrives> next_{};
  std::array<long long, EightJoints::kDrives> count_{};
  EightJoints::Command command_{};
};

std::vector<EightJoints::Values> truthOver(const Trains& trains, double end_s) {
  HandEight hand{EightJoints{}};
  Staircase stairs(trains);
  const auto per_look = std::llround(kLook_s / HandEight::kStep_s);
  std::vector<EightJoints::Values> truth;
  for (long long i = 0; i < std::llround(end_s / kLook_s); ++i) {
    for (long long k = 0; k < per_look; ++k) hand.stepStair(stairs.upTo(hand.time_s()));
    truth.push_back(hand.q());
  }
  return truth;
}

std::vector<twin::DriveCommand> held(const EightJoints::Command& command) {
  std::vector<twin::DriveCommand> commands;
  for (const double value : command) commands.push_back({value, value, value});
  return commands;
}

enum class Scheme { kMean, kEdges, kSample };

EightErrors errorsOf(Scheme scheme, const Trains& trains, const std::vector<EightJoints::Values>& truth,
                     double step_s) {
  twin::ReferenceSolver solver(twinEight(EightJoints{}), step_s,
                               twin::ReferenceSolver::Accelerations::kEveryStage);
  std::vector<twin::PulseCommand> means;
  for (std::size_t i = 0; i < trains.size(); ++i) {
    means.emplace_back(kPulse[i]);
    means.back().incoming() = trains[i];
  }
  Staircase stairs(trains);
  EightErrors errors;
  const auto per_look = std::llround(kLook_s / step_s);
  long long n = 0;
  for (const auto& wanted : truth) {
    for (long long k = 0; k < per_look; ++k, ++n) {
      const double begin_s = static_cast<double>(n) * step_s;
      const double end_s = static_cast<double>(n + 1) * step_s;
      if (scheme == Scheme::kMean) {
        EightJoints::Command mean{};
        for (std::size_t i = 0; i < means.size(); ++i) mean[i] = means[i].meanOver(begin_s, end_s);
        solver.step(begin_s, held(mean));
      } else if (scheme == Scheme::kSample) {
        solver.step(begin_s, held(stairs.upTo(begin_s)));
      } else {
        for (double now_s = begin_s; now_s < end_s - kEdgeSlack_s;) {
          const auto commands = held(stairs.upTo(now_s));
          const double until_s = std::min(stairs.nextEdge_s(), end_s);
          solver.stepBy(now_s, until_s - now_s, commands);
          now_s = until_s;
        }
      }
    }
    errors.add(wanted, jointsOf(solver.q()));
  }
  return errors;
}

}  // namespace

Section pulseTrains(const Context& context) {
  const double end_s = context.effort == Effort::kQuick ? 0.03 : 0.2;
  const Trains trains = trainsOver(end_s);
  const auto truth = truthOver(trains, end_s);
  std::size_t edges = 0;
  for (const Edges& train : trains) edges += train.size();
  Section section;
  section.title = "Trains of pulses: area mean, split at each edge, sampled";
  section.markdown = fmt::format(
      "The eight joints again, every drive fed by pulses: belt and gantry 12.5 µm, the stepper 1/16 of a "
      "full "
      "step, the galvo\n12.5 urad; {} edges in {:g} s. The truth holds the staircase over steps of 0.2 µs, "
      "on "
      "whose grid the edges lie. Largest\nerror of the spot, µm.\n\n",
      edges, end_s);
  constexpr std::array kSteps_us{5.0, 10.0, 20.0};
  std::array<PlotLine, 3> lines{PlotLine{"area mean over the step (what the twin does)", {}, true, true},
                                PlotLine{"split at each edge", {}, true, true},
                                PlotLine{"sampled at the step's begin", {}, true, true}};
  std::vector<std::vector<std::string>> rows;
  for (const double step_us : kSteps_us) {
    rows.push_back({fmt::format("{:g}", step_us)});
    for (const Scheme scheme : {Scheme::kMean, Scheme::kEdges, Scheme::kSample}) {
      const double spot_um = errorsOf(scheme, trains, truth, step_us * 1e-6).spot_um;
      lines.at(static_cast<std::size_t>(scheme)).points.emplace_back(step_us, spot_um);
      rows.back().push_back(figureText(spot_um));
    }
  }
  section.markdown += markdownTable({"step, µs", "area mean", "split at each edge", "sampled"}, rows);
  const auto at_10us = [&](Scheme scheme) {
    return lines.at(static_cast<std::size_t>(scheme)).points[1].y();
  };
  section.atMost("spot at 10 µs, area mean", at_10us(Scheme::kMean), 1.0, "µm");
  section.atMost("spot at 10 µs, split at each edge", at_10us(Scheme::kEdges), 1.0, "µm");
  section.atLeast("sampling is worse than the area mean by a factor of",
                  at_10us(Scheme::kSample) / at_10us(Scheme::kMean), 10.0, "");
  LinePlot plot{
      "Trains of pulses: largest error of the spot", {"step, µs", true}, {"µm", true}, {}, {{1.0, "1 µm"}}};
  plot.lines.assign(lines.begin(), lines.end());
  section.figures.push_back({"pulse-trains", plot.title, svgOf(plot)});
  return section;
}

}  // namespace kerfbench::validation
