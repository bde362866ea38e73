// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "twin/sheet/cubic_spline.h"

namespace kerfbench::twin {

/// Table of splineWeights() at 1024 places between two nodes.
class SplineWeightTable {
 public:
  SplineWeightTable() {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      storeQuad(&weights_[4 * i], splineWeights((static_cast<float>(i) + 0.5F) / kPlaces));
    }
  }
  [[nodiscard]] Quad at(float t) const { return of(indexOf(t)); }
  /// Number of the table's place for t in [0, 1).
  static int indexOf(float t) { return static_cast<int>(t * static_cast<float>(kPlaces)); }
  [[nodiscard]] Quad of(int index) const { return loadQuad(weights_.data() + 4 * index); }

 private:
  static constexpr std::size_t kPlaces = 1024;
  std::array<float, 4 * kPlaces> weights_{};
};

}  // namespace kerfbench::twin
