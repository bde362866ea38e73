// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "hil/vision/kerf_scan.h"

namespace kerfbench::hil {

/// Kerf tiles as files: pictures, and `tiles.yaml` with the place of the camera for each of them.
///
///     version: 1
///     tiles:
///       - {file: tile-0000.png, unit: 0, p_TV_mm: [-12.5, 40]}     # unit: default 0
class TileFolder final : public TileSource {
 public:
  /// @throws ConfigError with everything that is wrong, pictures that are not there included.
  explicit TileFolder(const std::filesystem::path& folder);

  /// @throws std::invalid_argument that names a picture that cannot be read.
  std::vector<KerfTile> nextBatch(std::size_t max) override;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    std::filesystem::path file;
    int unit{};
    Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};
  };
  std::vector<Entry> entries_;
  std::size_t next_{0};
};

/// Writes all tiles of a source into a folder, which is made if need be; the list comes last, so that it is
/// there only with all its pictures. @throws std::system_error.
void writeTiles(TileSource& source, const std::filesystem::path& folder);

}  // namespace kerfbench::hil
