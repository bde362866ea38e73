// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/cut_twice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kSameMm = 0.01;
constexpr double kLeastMm = 0.05;
constexpr std::size_t kMostFindings = 100;
/// Largest number of pairs: bounds the time on drawings in which everything lies above everything.
constexpr std::size_t kMostSegmentPairs = 50'000'000;

struct Extent {
  const Segment* segment{};
  double low_mm{}, high_mm{};
};

Extent extentOf(const Segment& segment) {
  if (segment.isArc()) {
    const double x = segment.centre_mm.x();
    return {&segment, x - segment.radiusMm(), x + segment.radiusMm()};
  }
  return {&segment, std::min(segment.start_mm.x(), segment.end_mm.x()),
          std::max(segment.start_mm.x(), segment.end_mm.x())};
}

double overlapOfLines(const Segment& a, const Segment& b) {
  const Vector2d t = a.tangentAt(0.0);
  const Vector2d from = b.start_mm - a.start_mm;
  const Vector2d to = b.end_mm - a.start_mm;
  double s0 = from.dot(t);
  double s1 = to.dot(t);
  double d0 = cross(t, from);
  double d1 = cross(t, to);
  if (s0 > s1) {
    std::swap(s0, s1);
    std::swap(d0, d1);
  }
  const double first = std::max(0.0, s0);
  const double last = std::min(a.lengthMm(), s1);
  if (last <= first || s1 <= s0) return 0.0;
  const auto distance = [&](double s) { return std::abs(d0 + (d1 - d0) * (s - s0) / (s1 - s0)); };
  return std::max(distance(first), distance(last)) < kSameMm ? last - first : 0.0;
}

double overlapOfArcs(const Segment& a, const Segment& b) {
  if ((a.centre_mm - b.centre_mm).norm() + std::abs(a.radiusMm() - b.radiusMm()) > kSameMm) return 0.0;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  // The spans are counter-clockwise, from the arcs' first angles.
  const auto span = [&](const Segment& arc) {
    const Vector2d r = (arc.sweep_rad > 0.0 ? arc.start_mm : arc.end_mm) - arc.centre_mm;
    return std::pair(std::atan2(r.y(), r.x()), std::min(std::abs(arc.sweep_rad), kTurn));
  };
  const auto [a0, a_sweep] = span(a);
  const auto [b0, b_sweep] = span(b);
  double ahead = std::fmod(b0 - a0, kTurn);
  if (ahead < 0.0) ahead += kTurn;
  double shared = std::max(0.0, std::min(a_sweep, ahead + b_sweep) - ahead);
  shared += std::max(0.0, std::min(a_sweep, ahead + b_sweep - kTurn));
  return shared * a.radiusMm();
}

}  // namespace

std::vector<std::string> cutTwice(const std::vector<Segment>& path) {
  std::vector<Extent> marks;
  for (const Segment& segment : path) {
    if (!segment.jump && segment.z > 0.0) marks.push_back(extentOf(segment));
  }
  std::stable_sort(marks.begin(), marks.end(),
                   [](const Extent& a, const Extent& b) { return a.low_mm < b.low_mm; });
  std::vector<std::string> findings;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (std::size_t j = i + 1; j < marks.size() && marks[j].low_mm <= marks[i].high_mm + kSameMm; ++j) {
      if (++pairs > kMostSegmentPairs || findings.size() >= kMostFindings) {
        findings.emplace_back("not all marks were compared with each other: there are too many");
        return findings;
      }
      const Segment& a = *marks[i].segment;
      const Segment& b = *marks[j].segment;
      if (a.isArc() != b.isArc()) continue;
      const double shared_mm = a.isArc() ? overlapOfArcs(a, b) : overlapOfLines(a, b);
      if (shared_mm <= kLeastMm) continue;
      findings.push_back(fmt::format("G-code line {}: {:.3f} mm of it are burnt by line {} as well",
                                     std::max(a.line, b.line), shared_mm, std::min(a.line, b.line)));
    }
  }
  return findings;
}

}  // namespace kerfbench::planner
