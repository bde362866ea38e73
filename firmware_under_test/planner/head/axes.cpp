// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/head/axes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <Eigen/LU>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/head/correction.h"

namespace kerfbench::planner {

using Eigen::Vector2d;

namespace {

/// Grid of 17 x 17 places over the field; its rim, where the distortion is worst, and the middle are among
/// them.
std::vector<Vector2d> placesIn(const MachineParameters& machine) {
  constexpr int kParts = 16;
  std::vector<Vector2d> places;
  for (int i = 0; i <= kParts; ++i) {
    for (int k = 0; k <= kParts; ++k) {
      const auto place = [&](int axis, int index) {
        const double low = machine.field_min_mm[axis];
        return low + (machine.field_max_mm[axis] - low) * index / kParts;
      };
      places.emplace_back(place(0, i), place(1, k));
    }
  }
  places.emplace_back(0.0, 0.0);
  return places;
}

constexpr double kDifferenceMm = 0.5;

/// Second derivative of either axis in the worst direction, steps per mm²: the Frobenius norm of the Hessian.
Vector2d bendAt(const Axes& axes, const Vector2d& p) {
  const auto at = [&](double dx, double dy) { return axes.stepsAt(p + kDifferenceMm * Vector2d(dx, dy)); };
  const Vector2d xx = at(1, 0) - 2.0 * at(0, 0) + at(-1, 0);
  const Vector2d yy = at(0, 1) - 2.0 * at(0, 0) + at(0, -1);
  const Vector2d xy = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
  const Vector2d norm = (xx.array().square() + yy.array().square() + 2.0 * xy.array().square()).sqrt();
  return norm / (kDifferenceMm * kDifferenceMm);
}

}  // namespace

Axes::Axes(const MachineParameters& machine, const PlannerFaults& faults)
    : machine_(machine), pulses_(pulsesFor(machine.target, machine.drives)), faults_(faults) {
  if (correction() != nullptr) {
    boundSlopesBySampling();
    return;
  }
  if (machine.head != MachineParameters::Head::kTwoMirror) {
    x_per_mm_ = y_per_mm_ = formulaSlopes(Vector2d::Zero())(0, 0);
    return;
  }
  const double l = machine.throw_mm;
  const double nearest = l + machine.mirror_spacing_mm;
  const double x_far = std::max(std::abs(machine.field_min_mm[0]), std::abs(machine.field_max_mm[0]));
  const double y_far = std::max(std::abs(machine.field_min_mm[1]), std::abs(machine.field_max_mm[1]));
  x_per_mm_ = 0.5 / nearest / machine.mirror_step_rad;
  y_per_mm_ = 0.5 / l / machine.mirror_step_rad;
  // Derivative by y of half atan(x/D), D = sqrt(L² + y²) + d: it grows with |y|, and with |x| up to D.
  const double x_bound = std::min(x_far, nearest);
  x_per_y_mm_ = 0.5 * x_bound / (nearest * nearest + x_bound * x_bound) * y_far / std::hypot(l, y_far) /
                machine.mirror_step_rad;
  for (const Vector2d& p : placesIn(machine)) {
    bend_per_mm2_ = bend_per_mm2_.cwiseMax(bendAt(*this, p));
    const Vector2d dy(0.0, kDifferenceMm);
    const double x_per_y = (stepsAt(p + dy).x() - stepsAt(p - dy).x()) / (2.0 * kDifferenceMm);
    x_rates_.emplace_back(xStepsPerMm(p), std::abs(x_per_y));
  }
}

Vector2d Axes::accelerationBox(double speed_mm_s) const {
  if (machine_.head == MachineParameters::Head::kGantry || machine_.mirror_acceleration_rad_s2 <= 0.0 ||
      faults_.no_mirror_limit) {
    return Vector2d::Constant(1e12);
  }
  const double limit = machine_.mirror_acceleration_rad_s2 / machine_.mirror_step_rad;
  const Vector2d left = Vector2d::Constant(limit) - bend_per_mm2_ * (speed_mm_s * speed_mm_s);
  const double y = left.y() / y_per_mm_;
  double x = 1e12;
  for (const Vector2d& rate : x_rates_) x = std::min(x, (left.x() - rate.y() * y) / rate.x());
  return {x, y};
}

const CorrectionTable* Axes::correction() const {
  return faults_.no_pincushion ? nullptr : machine_.correction.get();
}

/// Bounds the slopes by samples. A table may bend anywhere, so the whole field is sampled, four places to a
/// cell of most tables.
void Axes::boundSlopesBySampling() {
  constexpr int kParts = 128;
  constexpr double kBetween = 1.01;
  const Vector2d low(machine_.field_min_mm[0], machine_.field_min_mm[1]);
  const Vector2d high(machine_.field_max_mm[0], machine_.field_max_mm[1]);
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const Vector2d share(static_cast<double>(i) / kParts, static_cast<double>(j) / kParts);
      const Eigen::Matrix2d slopes = kBetween * stepsPerMm(low + share.cwiseProduct(high - low)).cwiseAbs();
      x_per_mm_ = std::max(x_per_mm_, slopes(0, 0));
      x_per_y_mm_ = std::max(x_per_y_mm_, slopes(0, 1));
      y_per_x_mm_ = std::max(y_per_x_mm_, slopes(1, 0));
      y_per_mm_ = std::max(y_per_mm_, slopes(1, 1));
    }
  }
}

Vector2d Axes::formulaAt(const Vector2d& p_W_mm) const {
  if (machine_.head == MachineParameters::Head::kGantry) return p_W_mm / machine_.gantry_step_mm;
  if (machine_.head == MachineParameters::Head::kFTheta)
    return p_W_mm / (2.0 * machine_.focal_length_mm) / machine_.mirror_step_rad;
  // Formula of Cheng et al. 2014, eq. 2.
  const double l = machine_.throw_mm;
  const double reach = faults_.no_pincushion ? l : std::hypot(l, p_W_mm.y()) + machine_.mirror_spacing_mm;
  return Vector2d(0.5 * std::atan(p_W_mm.x() / reach), 0.5 * std::atan(p_W_mm.y() / l)) /
         machine_.mirror_step_rad;
}

Eigen::Matrix2d Axes::formulaSlopes(const Vector2d& p_W_mm) const {
  if (machine_.head == MachineParameters::Head::kGantry)
    return Eigen::Matrix2d::Identity() / machine_.gantry_step_mm;
  if (machine_.head == MachineParameters::Head::kFTheta)
    return Eigen::Matrix2d::Identity() / (2.0 * machine_.focal_length_mm) / machine_.mirror_step_rad;
  const double l = machine_.throw_mm;
  const double slant = std::hypot(l, p_W_mm.y());
  const double reach = faults_.no_pincushion ? l : slant + machine_.mirror_spacing_mm;
  const double reach_per_y = faults_.no_pincushion ? 0.0 : p_W_mm.y() / slant;
  const double square = reach * reach + p_W_mm.x() * p_W_mm.x();
  Eigen::Matrix2d slopes;
  slopes << 0.5 * reach / square, -0.5 * p_W_mm.x() * reach_per_y / square, 0.0, 0.5 * l / (slant * slant);
  return slopes / machine_.mirror_step_rad;
}

Vector2d Axes::stepsAt(const Vector2d& p_W_mm) const {
  const CorrectionTable* const table = correction();
  if (table == nullptr) return formulaAt(p_W_mm);
  const Vector2d d = table->at(p_W_mm).d;
  return table->unit() == CorrectionTable::Unit::kMm ? formulaAt(p_W_mm + d)
                                                     : Vector2d(formulaAt(p_W_mm) + d);
}

Vector2d Axes::wakesAt() const {
  return correction() == nullptr ? Vector2d::Zero() : placeAt(Vector2d::Zero());
}

Vector2d Axes::exactPlaceAt(const Vector2d& steps, const Vector2d& near_W_mm) const {
  // From a thousandth of a step on Newton's next steps leave but the rounding of numbers.
  constexpr int kMostSteps = 8;
  constexpr double kRounding_mm = 1e-12;
  Vector2d p_W_mm = placeAt(steps, near_W_mm);
  for (int i = 0; i < kMostSteps; ++i) {
    const Vector2d change = stepsPerMm(p_W_mm).inverse() * (stepsAt(p_W_mm) - steps);
    p_W_mm -= change;
    if (change.cwiseAbs().maxCoeff() < kRounding_mm) break;
  }
  return p_W_mm;
}

Vector2d Axes::placeAt(const Vector2d& steps, const Vector2d& near_W_mm) const {
  constexpr int kMostTries = 20;
  constexpr double kSteps = 1e-3;
  Vector2d p_W_mm = near_W_mm;
  for (int i = 0; i < kMostTries; ++i) {
    const Vector2d off = stepsAt(p_W_mm) - steps;
    if (off.cwiseAbs().maxCoeff() < kSteps) return p_W_mm;
    p_W_mm -= stepsPerMm(p_W_mm).inverse() * off;
  }
  const std::string table = correction() == nullptr ? "the head" : correction()->name();
  throw PlanError(table + ": no place of the field has its mirrors at " +
                  (steps.isZero() ? "rest" : fmt::format("({:.0f}, {:.0f}) steps", steps.x(), steps.y())));
}

Eigen::Matrix2d Axes::stepsPerMm(const Vector2d& p_W_mm) const {
  const CorrectionTable* const table = correction();
  if (table == nullptr) return formulaSlopes(p_W_mm);
  const CorrectionTable::Value value = table->at(p_W_mm);
  if (table->unit() == CorrectionTable::Unit::kSteps) return formulaSlopes(p_W_mm) + value.gradient;
  return formulaSlopes(p_W_mm + value.d) * (Eigen::Matrix2d::Identity() + value.gradient);
}

double Axes::xStepsPerMm(const Vector2d& p_W_mm) const { return stepsPerMm(p_W_mm)(0, 0); }

Vector2d Axes::budgetPerS() const {
  const auto first = static_cast<std::size_t>(firstAxis());
  return Vector2d(Target::stepBudget(pulses_.most_steps[first]),
                  Target::stepBudget(pulses_.most_steps[first + 1])) /
         periodS();
}

Vector2d Axes::axisLimits() const { return budgetPerS().cwiseQuotient(Vector2d(x_per_mm_, y_per_mm_)); }

double Axes::speedLimit(const Vector2d& direction, double belt_speed_mm_s) const {
  const Vector2d budget = budgetPerS();
  const double belt_per_s = belt_speed_mm_s * x_per_mm_;
  if (belt_per_s >= budget.x()) return 0.0;
  // Condition |s ux + v| kx + s |uy| kxy <= budget, solved for s on both sides of the absolute value.
  const double cross_rate = std::abs(direction.y()) * x_per_y_mm_;
  const double rate = direction.x() * x_per_mm_;
  double limit = budget.y() / std::max(std::abs(direction.y()) * y_per_mm_, 1e-12);
  if (y_per_x_mm_ > 0.0) {
    // The belt moves the y axis too: |s ux + v| kyx + s |uy| ky <= budget, on the safe side of the absolute
    // value.
    const double rest = budget.y() - belt_speed_mm_s * y_per_x_mm_;
    if (rest <= 0.0) return 0.0;
    const double both = std::abs(direction.y()) * y_per_mm_ + std::abs(direction.x()) * y_per_x_mm_;
    limit = std::min(limit, rest / std::max(both, 1e-12));
  }
  const double forward = rate + cross_rate;
  if (forward > 0.0) limit = std::min(limit, (budget.x() - belt_per_s) / forward);
  const double backward = cross_rate - rate;
  if (backward > 0.0) limit = std::min(limit, (budget.x() + belt_per_s) / backward);
  return limit;
}

int Axes::firstAxis() const {
  return machine_.head == MachineParameters::Head::kGantry ? KB_GANTRY_X : KB_GALVO_X;
}

}  // namespace kerfbench::planner
