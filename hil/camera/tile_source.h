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

/// Tiles of a web whose machine still runs: each unit's are handed out as soon as it has left the machine,
/// the others when the machine has stopped.
class TilesMeanwhile : public TileSource {
 public:
  /// Nobody measures any more: nothing waits from now on.
  virtual void close() = 0;
};

}  // namespace kerfbench::camera
