// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

inline constexpr double kNmPerMm = 1e6;

struct CHeaderOptions {
  enum class Value { kInt16, kInt32 };
  Value value{Value::kInt16};
  /// Unit of dx and dy, nm. 0: 1 nm for int32; for int16 the least that holds the largest value.
  std::uint32_t unit_nm{0};
  std::string prefix{"KB_CORRECTION"};  ///< Prefix of all names; capital letters, digits and '_'.
  /// An array of avr-gcc may not be larger than its int. Others bear more.
  std::size_t most_array_bytes{32767};
};

/// A table as a C header for firmware: static const arrays of places (int32, nm), dx and dy (int16 or int32,
/// in units of nm), the convention in its comment and in macros, and the SHA-256 of its numbers. C99, C++,
/// and avr-gcc, where the arrays lie in flash (PREFIX_STORAGE, PROGMEM unless defined before); arrays are
/// read by pgm_read_word or _dword there, by their _far kin beyond 64 KiB of flash.
/// @throws std::invalid_argument if a value does not fit, an array is larger than `most_array_bytes`, two
///   places round to the same nm, or the prefix is no name.
std::string cHeader(const AimGrid& grid, const CHeaderOptions& options = {});

/// Reads back what cHeader() wrote.
/// @throws TableFileError with every fault and its line; the hash must be that of the numbers.
AimGrid parseCHeader(const std::string& text, const std::string& name);

}  // namespace kerfbench::calibrate
