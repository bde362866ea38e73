// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace kerfbench::guest {

/// Pictures of 8-bit grey that the host has rendered, for a camera in the guest.
struct Film {
  int width_px{};
  int height_px{};
  std::vector<std::uint64_t> at_ns;  ///< Time of each picture, ascending.
  std::vector<std::uint8_t> pixels;  ///< Pixels of all pictures, one after the other.

  [[nodiscard]] std::span<const std::uint8_t> picture(std::size_t index) const;
};

/// Writes film.txt and film.raw into this folder. @throws std::runtime_error.
void writeFilm(const std::filesystem::path& folder, const Film& film);
/// Reads all of the film into memory: in the guest, time runs on while it waits for the host's disk.
/// @throws std::runtime_error.
Film readFilm(const std::filesystem::path& folder);

}  // namespace kerfbench::guest
