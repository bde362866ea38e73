// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/camera/tile_source.h"

namespace kerfbench::camera {

struct PictureSize {
  int width_px{}, height_px{};
};

/// Kerf tiles as files: pictures, and `tiles.yaml` with the place of the camera for each of them.
///
///     version: 1
///     tiles:
///       - {file: tile-0000.png, unit: 0, p_TV_mm: [-12.5, 40]}     # unit: default 0
class TileFolder final : public TileSource {
 public:
  /// `size`: that each picture must have.
  /// @throws ConfigError with everything that is wrong in the list: pictures that are not there, or there
  /// twice, included.
  explicit TileFolder(const std::filesystem::path& folder, std::optional<PictureSize> size = {});

  /// @throws ConfigError that names every picture, from the first of these to the last of the folder, that
  /// cannot be read or has another size.
  std::vector<KerfTile> nextBatch(std::size_t max) override;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// SHA-256 that stands for the list and all its pictures: of the lines that `sha256sum` prints for
  /// tiles.yaml and then for each picture, by the names and in the order of the list. @throws
  /// std::system_error.
  [[nodiscard]] std::string sha256OfSums() const;

 private:
  struct Entry {
    std::string name;  ///< Name of the file, in the folder.
    int unit{};
    Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};
  };
  [[nodiscard]] KerfTile read(const Entry& entry) const;
  [[nodiscard]] std::string faultsFrom(std::size_t first) const;

  std::filesystem::path folder_;
  std::optional<PictureSize> size_;
  std::vector<Entry> entries_;
  std::size_t next_{0};
};

/// Writes all tiles of a source into a folder, which is made if need be; the list comes last, so that it is
/// there only with all its pictures. @throws std::system_error.
void writeTiles(TileSource& source, const std::filesystem::path& folder);

}  // namespace kerfbench::camera
