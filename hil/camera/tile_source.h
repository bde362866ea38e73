// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace kerfbench::camera {

struct KerfTile;

/// Pulls tiles one at a time, so that they need not all be in memory.
class TileSource {
 public:
  virtual ~TileSource() = default;
  virtual std::vector<KerfTile> nextBatch(std::size_t max) = 0;
};

}  // namespace kerfbench::camera
