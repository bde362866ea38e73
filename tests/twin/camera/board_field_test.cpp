// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/board_field.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

double correlationOver(const BoardField& field, const Vector2d& step_mm) {
  double product = 0.0, square = 0.0;
  for (double y = -40.0; y < 40.0; y += 0.413) {
    for (double x = -40.0; x < 40.0; x += 0.397) {
      const double here = field.at({x, y});
      product += here * field.at(Vector2d(x, y) + step_mm);
      square += here * here;
    }
  }
  return product / square;
}

TEST(BoardField, HasZeroMeanUnitRmsAndStaysWithinItsLimit) {
  const BoardField field(7, 1, 0.2);
  double sum = 0.0, square = 0.0, fourth = 0.0, largest = 0.0, count = 0.0;
  for (double y = -60.0; y < 60.0; y += 0.313) {
    for (double x = -60.0; x < 60.0; x += 0.297) {
      const double value = field.at({x, y});
      sum += value;
      square += value * value;
      fourth += value * value * value * value;
      largest = std::max(largest, std::abs(value));
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 0.01);
  EXPECT_NEAR(std::sqrt(square / count), 1.0, 0.01);
  EXPECT_NEAR(fourth * count / (square * square), 3.0, 0.1) << "not normal";
  EXPECT_GT(largest, 3.5);
  EXPECT_LT(largest, BoardField::kLimit);
}

TEST(BoardField, ItsCorrelationFallsToOneOverEAtItsLength) {
  for (const double length_mm : {0.1, 0.25}) {
    const BoardField field(7, 2, length_mm);
    for (const double angle : {0.0, 0.8, 1.5708}) {
      const Vector2d along(std::cos(angle), std::sin(angle));
      EXPECT_NEAR(correlationOver(field, length_mm * along), 1.0 / std::numbers::e, 0.03);
      EXPECT_GT(correlationOver(field, 0.3 * length_mm * along), 0.88);
      EXPECT_NEAR(correlationOver(field, 4.0 * length_mm * along), 0.0, 0.03);
    }
  }
}

TEST(BoardField, FieldsOfOtherSeedsAndStreamsAreOthers) {
  const BoardField field(7, 1, 0.2);
  for (const BoardField& other : {BoardField(8, 1, 0.2), BoardField(7, 2, 0.2)}) {
    double product = 0.0, count = 0.0;
    for (double y = -40.0; y < 40.0; y += 0.413) {
      for (double x = -40.0; x < 40.0; x += 0.397, ++count) product += field.at({x, y}) * other.at({x, y});
    }
    EXPECT_NEAR(product / count, 0.0, 0.02);
  }
}

TEST(FieldPainter, PaintsTheFieldWhereverThePieceLies) {
  const BoardField field(7, 1, 0.2);
  FieldPainter painter(field);
  const Eigen::Rotation2Dd turn(0.3);
  for (const Vector2d& corner : {Vector2d(0, 0), Vector2d(-13.77, 4.21), Vector2d(100.3, -55.5)}) {
    const double pitch_mm = 0.09;
    PlanePatch::Nodes nodes;
    for (std::size_t n = 0; n < 9; ++n) {
      nodes[n] = corner + pitch_mm * (turn * Vector2d(0.5 * 12.0 * static_cast<double>(n % 3),
                                                      0.5 * 7.0 * static_cast<double>(n / 3)));
    }
    std::vector<float> out(12 * 7, 5.0F);
    painter.add(nodes, 12, 7, 2.0F, out);
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 12; ++x) {
        const Vector2d place = corner + pitch_mm * (turn * Vector2d(x + 0.5, y + 0.5));
        EXPECT_NEAR(out[static_cast<std::size_t>(12 * y + x)], 5.0 + 2.0 * field.at(place), 0.01);
      }
    }
  }
}

}  // namespace
}  // namespace kerfbench::twin
