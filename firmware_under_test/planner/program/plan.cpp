// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/order/cut_order.h"
#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

/// Widths of the band of equals that are tried when the belt is too fast for whole outlines: a wide band
/// jumps less, a narrow one keeps closer to the order in which the pieces leave.
constexpr double kBandsMm[] = {5.0, 15.0, 30.0, 60.0};

void require(const MachineParameters& machine, const JobParameters& job) {
  const std::vector<std::string> faults = jobIssues(machine, job);
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
}

/// Share of the belt speed that shorter orders must fit as well.
constexpr double kSpareSpeed = 1.1;
/// Most plans of the whole unit that test whether an order fits.
constexpr int kMostQuestions = 300;

/// Refuses drawings that no sheet can hold, or with too much to be put in order.
void requireSane(const dieline::Dieline& dieline) {
  constexpr double kFarthestMm = 1e5;
  std::string faults;
  int count = 0;
  if (dieline.entities.size() > kMostOrdered)
    throw PlanError(fmt::format("the drawing holds {} entities; {} can be put in order",
                                dieline.entities.size(), kMostOrdered));
  for (const dieline::Entity& entity : dieline.entities) {
    if (dieline::drawnFor(entity) == dieline::Process::kIgnore) continue;
    double farthest = 0.0;
    bool finite = true;
    for (int i = 0; i <= 16; ++i) {
      const Eigen::Vector2d p = dieline::pointAt(entity.curve, i / 16.0);
      finite = finite && p.allFinite();
      farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
    }
    if (finite && farthest <= kFarthestMm) continue;
    if (++count > 20) continue;
    faults += fmt::format("{}E{}{}: reaches {} mm, out of all bounds", faults.empty() ? "" : "\n", entity.id,
                          entity.origin.empty() ? "" : " (" + entity.origin + ")",
                          finite ? fmt::format("{:g}", farthest) : "no number of");
  }
  if (count > 20) faults += fmt::format("\nand {} more", count - 20);
  if (!faults.empty()) throw PlanError(faults);
}

const std::string& needed(const std::string& gcode) {
  if (gcode.empty()) throw PlanError("the dieline holds nothing to cut");
  return gcode;
}

std::vector<Segment> withJumps(const std::vector<std::vector<Segment>>& pieces) {
  std::vector<Segment> path;
  for (const std::vector<Segment>& piece : pieces) {
    for (const Segment& segment : piece) {
      if (!path.empty() && (segment.start_mm - path.back().end_mm).norm() > kJoinMm) {
        Segment jump;
        jump.jump = true;
        jump.start_mm = path.back().end_mm;
        jump.end_mm = segment.start_mm;
        path.push_back(jump);
      }
      path.push_back(segment);
    }
  }
  return path;
}

std::vector<std::string> processNames(const dieline::Dieline& dieline) {
  int last = 0;
  for (const dieline::Entity& entity : dieline.entities) last = std::max(last, entity.id);
  std::vector<std::string> names(std::size_t(last) + 1, "mark");
  for (const dieline::Entity& entity : dieline.entities) {
    names[std::size_t(entity.id)] = std::string(dieline::processName(entity.process));
  }
  return names;
}

/// G-code in the given order. On a moving sheet the senses in which the entities are drawn may fit where the
/// shortest way does not.
std::string gcodeByHand(const dieline::Dieline& dieline, const MachineParameters& machine,
                        const JobParameters& job, const PlannerFaults& faults) {
  if (const auto wrong = orderFaults(dieline, job.given_order); !wrong.empty())
    throw PlanError(fmt::format("order: {}", fmt::join(wrong, "\norder: ")));
  const auto write = [&](Senses senses) {
    return needed(writeGcode(piecesOf(handOrder(dieline, job, faults, senses), job), processNames(dieline)));
  };
  std::string shortest = write(Senses::kNearest);
  if (speedWhileCutting(job) <= 0.0) return shortest;
  const Axes axes(machine, faults);
  const auto highest = [&](const std::string& gcode) {
    return maxBeltSpeed(unitOf(readGcode(gcode)), machine, job, axes);
  };
  const double speed = highest(shortest);
  if (speed >= job.belt_speed_mm_s) return shortest;
  std::string drawn = write(Senses::kDrawn);
  return highest(drawn) > speed ? drawn : shortest;
}

}  // namespace

std::string makeGcode(const dieline::Dieline& dieline, const MachineParameters& machine,
                      const JobParameters& job, const PlannerFaults& faults) {
  require(machine, job);
  requireSane(dieline);
  const auto write = [&](const std::vector<Stop>& order) {
    return writeGcode(piecesOf(order, job), processNames(dieline));
  };
  if (job.order == JobParameters::Order::kDrawn) return needed(write(drawnOrder(dieline, job, faults)));
  if (job.order == JobParameters::Order::kGiven) return gcodeByHand(dieline, machine, job, faults);
  std::vector<Stop> order = nearestOrder(dieline, job, faults, OrderOptions{});
  std::string best = needed(write(order));
  if (speedWhileCutting(job) <= 0.0) {
    return job.order == JobParameters::Order::kShortest ? write(shortened(std::move(order), {}, 0)) : best;
  }
  const Axes axes(machine, faults);
  const auto highest = [&](const std::string& gcode) {
    return maxBeltSpeed(unitOf(readGcode(gcode)), machine, job, axes);
  };
  double best_speed = highest(best);
  for (const bool place_before_process : {false, true}) {
    for (const double band_mm : kBandsMm) {
      if (best_speed >= job.belt_speed_mm_s) break;
      std::vector<Stop> broken = nearestOrder(dieline, job, faults, {true, place_before_process, band_mm});
      const std::string text = write(broken);
      const double speed = highest(text);
      if (speed <= best_speed) continue;
      best = text;
      best_speed = speed;
      order = std::move(broken);
    }
  }
  if (job.order != JobParameters::Order::kShortest || best_speed < job.belt_speed_mm_s) return best;
  // The line may run faster than configured, so a shorter path must not cost all the room there was.
  const double spare_speed = std::min(best_speed, kSpareSpeed * job.belt_speed_mm_s);
  const auto fits = [&](const std::vector<Stop>& candidate) {
    const std::vector<Segment> path = withJumps(piecesOf(candidate, job));
    return solve(path, machine, job, axes, job.belt_speed_mm_s).solution.has_value() &&
           solve(path, machine, job, axes, spare_speed).solution.has_value();
  };
  const std::string shorter = write(shortened(order, fits, kMostQuestions));
  return highest(shorter) >= job.belt_speed_mm_s ? shorter : best;
}

Plan planFromGcode(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                   const PlannerFaults& faults) {
  return planFromChecked(checkJob(gcode, machine, job, faults), gcode, machine, job, faults);
}

Plan planFromChecked(const CheckResult& checked, const std::string& gcode, const MachineParameters& machine,
                     const JobParameters& job, const PlannerFaults& faults) {
  if (!checked.solution) throw PlanError(fmt::format("{}", fmt::join(checked.errors, "\n")));
  const std::vector<Segment> path = unitOf(readGcode(gcode));
  const Axes axes(machine, faults);
  const double v = speedWhileCutting(job);
  const Solution& solution = *checked.solution;
  Plan plan;
  plan.gcode = gcode;
  plan.max_belt_speed_mm_s = checked.max_belt_speed_mm_s;

  const UnitLayout& layout = solution.layoutOf(0);
  const UnitLayout& next = solution.layoutOf(job.units > 1 ? 1 : 0);
  const double period_s = axes.periodS();
  plan.unit_time_s = (layout.catch_up_periods + layout.sheet_periods) * period_s;
  int return_periods = Reposition(layout.end_W_mm, v, next.park_W_mm, job, axes).periods();
  if (job.stop_and_go) return_periods = std::max(return_periods, feedOfPitchPeriods(job, period_s));
  plan.cycle_time_s = plan.unit_time_s + return_periods * period_s;
  plan.x_ref_mm = layout.x_ref_mm;
  plan.jump_length_mm = solution.paths.front().jump_length_mm;
  for (const Segment& segment : path) {
    if (!segment.jump && segment.z != 0.0) plan.cut_length_mm += segment.lengthMm();
  }
  constexpr double kMostPeriods = 1.5e8;  // 33 hours; some 60 bytes each
  if (job.units * plan.cycle_time_s > kMostPeriods * period_s) {
    throw PlanError(fmt::format("{} units of {:.3f} s are more than one program may hold ({:.0f} h)",
                                job.units, plan.cycle_time_s, kMostPeriods * period_s / 3600.0));
  }
  // Margin for a job at its highest speed, which must bear the small speed variation of any line.
  constexpr double kWaver = 1.02;
  if (v > 0.0 && !job.feed_by_controller)
    plan.belt_stop_mm_s = std::max(plan.max_belt_speed_mm_s, kWaver * v);
  plan.program = makeProgram(solution, machine, job, faults, axes, plan.belt_stop_mm_s);
  return plan;
}

Plan plan(const dieline::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
          const PlannerFaults& faults) {
  return planFromGcode(makeGcode(dieline, machine, job, faults), machine, job, faults);
}

}  // namespace kerfbench::planner
