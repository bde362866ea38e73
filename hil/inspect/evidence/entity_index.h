// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/spot_association.h"

namespace kerfbench::inspect {

/// Which entities come near a point: a hash grid of samples along the curves.
class EntityIndex {
 public:
  explicit EntityIndex(const dieline::Dieline& dieline) {
    for (const dieline::Entity& entity : dieline.entities) {
      if (entity.process == dieline::Process::kIgnore) continue;
      for (const double u : dieline::stations(entity.curve, 0.5 * kSearch_mm)) {
        auto& cell = cells_[keyOf(cellOf(dieline::pointAt(entity.curve, u)))];
        if (cell.empty() || cell.back() != entity.id) cell.push_back(entity.id);
      }
    }
  }

  /// Ids in ascending order; all that are within kSearch_mm, and maybe some more.
  [[nodiscard]] std::vector<int> near(const Eigen::Vector2d& p_mm) const {
    std::vector<int> ids;
    const Eigen::Vector2i centre = cellOf(p_mm);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = cells_.find(keyOf(centre + Eigen::Vector2i(dx, dy)));
        if (found != cells_.end()) ids.insert(ids.end(), found->second.begin(), found->second.end());
      }
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
  }

 private:
  // A sample lies within a quarter of the search radius of any point of the curve.
  static constexpr double kCell_mm = 1.25 * kSearch_mm;

  static Eigen::Vector2i cellOf(const Eigen::Vector2d& p_mm) {
    return (p_mm / kCell_mm).array().floor().cast<int>();
  }
  static std::int64_t keyOf(const Eigen::Vector2i& cell) {
    return (static_cast<std::int64_t>(cell.x()) << 32) + cell.y();
  }

  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace kerfbench::inspect
