// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/board_print.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;
using Anchor = PrintPage::Anchor;

constexpr double kClear_mm = 5.0;   // Around the marks: what is printed there could be taken for their rim.
constexpr double kSide_mm = 16.0;   // Left and right: ticks of the origin and a ruler.
constexpr double kAbove_mm = 12.0;  // Above: ticks.
constexpr double kBelow_mm = 26.0;  // Below: ticks, ruler, axes; lines of text come on top.
constexpr double kType_mm = 2.6, kSmall_mm = 2.0, kLine_mm = 3.9;
constexpr double kTick_mm = 3.0;
constexpr double kLongestRuler_mm = 200.0;

Eigen::AlignedBox2d boxOf(const calibrate::MarkJob& job) {
  Eigen::AlignedBox2d box;
  for (const RegistrationMark& mark : job.print) {
    const Vector2d radius = Vector2d::Constant(0.5 * mark.diameter_mm);
    box.extend(mark.p_SM_mm - radius);
    box.extend(mark.p_SM_mm + radius);
  }
  return {box.min() - Vector2d::Constant(kClear_mm), box.max() + Vector2d::Constant(kClear_mm)};
}

double rulerFor(double side_mm) { return std::min(kLongestRuler_mm, 10.0 * std::floor(side_mm / 10.0)); }

/// A ruler from `from`, along `along`, with its numbers on the side of `numbers`.
void ruler(PrintPage& page, const Vector2d& from, double length_mm, const Vector2d& along,
           const Vector2d& numbers) {
  page.shapes.emplace_back(PrintPage::Line{from, from + length_mm * along});
  for (int mm = 0; mm <= static_cast<int>(length_mm); ++mm) {
    const double tick = mm % 10 == 0 ? kTick_mm : mm % 5 == 0 ? 2.0 : 1.2;
    const Vector2d at = from + mm * along;
    page.shapes.emplace_back(PrintPage::Line{at, at - tick * numbers, 0.12});
    if (mm % 10 != 0) continue;
    const Vector2d beside = at + Vector2d(numbers.x() < 0.0 ? -0.8 : 0.0, numbers.y() < 0.0 ? -2.4 : -0.7);
    page.shapes.emplace_back(PrintPage::Text{beside, kSmall_mm, std::to_string(mm),
                                             numbers.x() < 0.0 ? Anchor::kRight : Anchor::kMiddle});
  }
}

/// Ticks beyond the marks that point at the lines x = 0 and y = 0 of S; where they cross is the origin.
void originTicks(PrintPage& page, const Eigen::AlignedBox2d& box, const Vector2d& p_SP_mm) {
  const auto place = [&](const Vector2d& p_S_mm) -> Vector2d { return p_S_mm + p_SP_mm; };
  const double x = std::clamp(0.0, box.min().x(), box.max().x());
  const double y = std::clamp(0.0, box.min().y(), box.max().y());
  for (const double side : {box.min().y() - 0.5 * kTick_mm, box.max().y() + 0.5 * kTick_mm}) {
    const Vector2d at = place({x, side});
    page.shapes.emplace_back(PrintPage::Line{at - Vector2d(0.0, 1.0), at + Vector2d(0.0, 2.0)});
    page.shapes.emplace_back(PrintPage::Text{at + Vector2d(1.0, 0.0), kSmall_mm, fmt::format("x = {:g}", x)});
  }
  for (const double side : {box.min().x() - 0.5 * kTick_mm, box.max().x() + 0.5 * kTick_mm}) {
    const Vector2d at = place({side, y});
    page.shapes.emplace_back(PrintPage::Line{at - Vector2d(1.5, 0.0), at + Vector2d(1.5, 0.0)});
    page.shapes.emplace_back(
        PrintPage::Text{at + Vector2d(0.0, 0.8), kSmall_mm, fmt::format("y = {:g}", y), Anchor::kMiddle});
  }
}

void axes(PrintPage& page, const Vector2d& corner) {
  constexpr double kAxis_mm = 14.0;
  page.arrow(corner, corner + Vector2d(kAxis_mm, 0.0));
  page.arrow(corner, corner + Vector2d(0.0, kAxis_mm - 3.0));
  page.shapes.emplace_back(
      PrintPage::Text{corner + Vector2d(kAxis_mm + 1.0, -0.8), kType_mm, "+x, the belt runs this way"});
  page.shapes.emplace_back(PrintPage::Text{corner + Vector2d(1.2, kAxis_mm - 4.5), kType_mm, "+y"});
}

}  // namespace

Vector2d rulersOf(const calibrate::MarkJob& job) {
  const Vector2d sides = boxOf(job).sizes();
  return {rulerFor(sides.x()), rulerFor(sides.y())};
}

PrintPage boardPrint(const calibrate::MarkJob& job, const BoardNotes& notes) {
  const Eigen::AlignedBox2d box = boxOf(job);
  PrintPage page;
  const double text_mm = kLine_mm * static_cast<double>(notes.to_do.size() + 1) + 3.0;
  page.size_mm = box.sizes() + Vector2d(2.0 * kSide_mm, kAbove_mm + kBelow_mm + text_mm);
  const Vector2d p_SP_mm = Vector2d(kSide_mm, kBelow_mm + text_mm) - box.min();
  for (const RegistrationMark& mark : job.print)
    page.shapes.emplace_back(PrintPage::Disc{mark.p_SM_mm + p_SP_mm, 0.5 * mark.diameter_mm});
  originTicks(page, box, p_SP_mm);
  const Vector2d rulers = rulersOf(job);
  ruler(page, {kSide_mm, text_mm + kBelow_mm - 6.0}, rulers.x(), Vector2d::UnitX(), -Vector2d::UnitY());
  ruler(page, {kSide_mm - 9.0, text_mm + kBelow_mm}, rulers.y(), Vector2d::UnitY(), -Vector2d::UnitX());
  axes(page, {kSide_mm, text_mm + 2.0});
  double line_mm = text_mm - kLine_mm;
  const auto say = [&](const std::string& text) {
    page.shapes.emplace_back(PrintPage::Text{{kSide_mm, line_mm}, kType_mm, text});
    line_mm -= kLine_mm;
  };
  say(fmt::format("{} · {} · sheet {} · {}", job.machine, job.name, notes.sheet, job.date));
  for (std::size_t k = 0; k < notes.to_do.size(); ++k) say(fmt::format("{}. {}", k + 1, notes.to_do[k]));
  return page;
}

}  // namespace kerfbench::head_service
