// SPDX-License-Identifier: Apache-2.0
#pragma once

// Parts that writer and reader of C headers share; for use inside of this folder.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::calibrate {

/// The numbers of a C header.
struct CHeaderNumbers {
  using Array = std::vector<std::int64_t>;
  std::int64_t unit_nm{};
  std::int64_t hermite{};  ///< Nonzero: Hermite between the nodes; 0: bilinear.
  std::int64_t outside{};  ///< Value of enum Outside.
  std::array<Array, 4> arrays;
};

inline constexpr std::array<const char*, 4> kCHeaderArrays{"_X_NM", "_Y_NM", "_DX", "_DY"};

std::string listed(const CHeaderNumbers::Array& values, std::size_t per_line);
/// SHA-256 of all numbers, one a line.
std::string hashOf(const CHeaderNumbers& numbers);

}  // namespace kerfbench::calibrate
