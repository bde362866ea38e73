// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/gate_fit.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "hil/diagnose/drawing.h"

namespace kerfbench::diagnose {
namespace {

constexpr std::size_t kFewestInstants = 20;
constexpr double kMost = 0.8;
constexpr double kFew = 0.5;

}  // namespace

bool isGateInverted(const GatedPath& path, const PlaceOfSteps& place, const dieline::Dieline& dieline,
                    const PrintLayout& print, double near_mm) {
  const Drawing drawing(dieline, print);
  if (std::min(path.open.size(), path.closed.size()) < kFewestInstants || drawing.empty()) return false;
  const auto isOnLine = [&](const LitInstant& instant) {
    std::optional<Eigen::Vector2d> p = place(instant.steps);
    if (!p || !p->allFinite()) return false;
    p->x() -= instant.sheet_x_mm;
    return drawing.awayFrom(drawing.inUnit(*p)).norm() <= near_mm;
  };
  const auto shareOnLines = [&](const std::vector<LitInstant>& instants) {
    return static_cast<double>(std::ranges::count_if(instants, isOnLine)) /
           static_cast<double>(instants.size());
  };
  return shareOnLines(path.closed) >= kMost && shareOnLines(path.open) < kFew;
}

}  // namespace kerfbench::diagnose
