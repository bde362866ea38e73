// SPDX-License-Identifier: Apache-2.0
#include "twin/five_axis/folded_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "twin/five_axis/five_axis_head.h"

namespace kerfbench::twin {
namespace {

constexpr double kStep_mm = 0.04;
constexpr double kStep_rad = 0.2 * std::numbers::pi / 180.0;

/// Energy of a move with the beam on.
double energyOf(const FiveAxisDescription& head, double way_mm, double turn_rad) {
  if (head.power_follows_speed) return head.power_w * way_mm / head.feed_mm_s;
  return head.power_w * std::max(way_mm / head.feed_mm_s, turn_rad / head.turn_speed_rad_s);
}

const FaceSpot* onFace(const std::vector<FaceSpot>& spots, std::size_t face) {
  const auto found = std::ranges::find_if(spots, [&](const FaceSpot& spot) { return spot.face == face; });
  return found == spots.end() ? nullptr : &*found;
}

void burn(const std::vector<FaceSpot>& from, const std::vector<FaceSpot>& to, double energy_j,
          std::vector<Sheet>& sheets) {
  for (std::size_t face = 0; face < sheets.size(); ++face) {
    const FaceSpot* a = onFace(from, face);
    const FaceSpot* b = onFace(to, face);
    if (a == nullptr && b == nullptr) continue;
    // Where it comes upon a face or leaves it, half of the step's energy falls there.
    const bool whole = a != nullptr && b != nullptr;
    const FaceSpot& first = a != nullptr ? *a : *b;
    const FaceSpot& last = b != nullptr ? *b : *a;
    sheets[face].burn(first.footprint, last.footprint, whole ? energy_j : 0.5 * energy_j);
  }
}

}  // namespace

FoldedCut cutFolded(const FiveAxisDescription& head, const FoldedBlank& blank, const BoardDescription& board,
                    const std::vector<FiveAxisMove>& moves) {
  FoldedCut cut;
  for (std::size_t i = 0; i < blank.faces().size(); ++i) cut.sheets.emplace_back(board);
  FiveAxisHead machine(head);
  std::optional<FiveAxisPose> at;
  std::vector<FaceSpot> spots;
  for (const FiveAxisMove& move : moves) {
    if (!at) {
      at = move.to;
      spots = blank.meet(machine.moveTo(*at));
      continue;
    }
    const Eigen::Vector3d way_mm = move.to.p_WQ_mm - at->p_WQ_mm;
    const double turn_rad =
        std::max(std::abs(move.to.a_rad - at->a_rad), std::abs(move.to.c_rad - at->c_rad));
    const auto steps =
        static_cast<int>(std::max(1.0, std::ceil(std::max(way_mm.norm() / kStep_mm, turn_rad / kStep_rad))));
    const double energy_j = move.cuts ? energyOf(head, way_mm.norm(), turn_rad) / steps : 0.0;
    for (int i = 1; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      std::vector<FaceSpot> next = blank.meet(
          machine.moveTo({at->p_WQ_mm + share * way_mm, at->a_rad + share * (move.to.a_rad - at->a_rad),
                          at->c_rad + share * (move.to.c_rad - at->c_rad)}));
      if (energy_j > 0.0) burn(spots, next, energy_j, cut.sheets);
      if (move.cuts && next.empty()) cut.missed_mm += way_mm.norm() / steps;
      spots = std::move(next);
    }
    if (move.cuts) cut.cut_mm += way_mm.norm();
    at = move.to;
  }
  return cut;
}

}  // namespace kerfbench::twin
