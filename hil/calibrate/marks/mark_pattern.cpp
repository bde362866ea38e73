// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_pattern.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Geometry>

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

Vector2d quarterTurned(Vector2d p, int quarters) {
  for (int q = 0; q < quarters; ++q) p = Vector2d(-p.y(), p.x());
  return p;
}

const Eigen::Matrix2d& rotationSM() {
  static const Eigen::Matrix2d R_SM = Eigen::Rotation2Dd(kMarkTurn_rad).toRotationMatrix();
  return R_SM;
}

}  // namespace

Vector2d slotCentre(int slot) {
  if (slot < 0 || slot >= kMarkSlots) throw std::out_of_range("field marks: no such slot");
  constexpr std::size_t kSlotsInRow = kSlot.size();
  constexpr std::size_t kSlotsInQuadrant = kSlotsInRow * kSlotsInRow;
  const auto at = static_cast<std::size_t>(slot);
  return quarterTurned({kSlot.at(at % kSlotsInRow), kSlot.at(at % kSlotsInQuadrant / kSlotsInRow)},
                       static_cast<int>(at / kSlotsInQuadrant));
}

std::array<MarkStroke, 4> markArms(double size_mm) {
  const double half_mm = 0.5 * size_mm;
  std::array<MarkStroke, 4> arms;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    const Vector2d direction = rotationSM() * quarterTurned(Vector2d::UnitX(), static_cast<int>(k));
    arms.at(k) = {kArmFrom * half_mm * direction, half_mm * direction};
  }
  return arms;
}

std::vector<MarkStroke> markTicks(int number, double size_mm) {
  const double half_mm = 0.5 * size_mm;
  const MarkWord& word = markWord(number);
  std::vector<MarkStroke> ticks;
  for (int slot = 0; slot < kMarkSlots; ++slot) {
    if (!word.test(static_cast<std::size_t>(slot))) continue;
    const Vector2d centre = slotCentre(slot);
    const Vector2d along =
        0.5 * kTick * Vector2d(std::copysign(1.0, centre.x()), std::copysign(1.0, centre.y())).normalized();
    ticks.push_back(
        {half_mm * (rotationSM() * (centre - along)), half_mm * (rotationSM() * (centre + along))});
  }
  return ticks;
}

}  // namespace kerfbench::calibrate
