// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

/// JCZ's files of correction, 65 x 65 pairs, little-endian, label in ASCII or UTF-16LE filled to 22 bytes:
///
///     v1 "LMC1COR_1.0"   0x018: 63 doubles, [43] (0x170) units per mm; 0x210: pairs of double; 68 128 bytes
///     v2 "JCZ_COR_2_1"   0x01C: double, units per mm; 0x024: pairs of int32; 33 836 bytes, often 4 more
///
/// The numbers are galvo units, ±32767: the board gets them as sign and 15 bits. Nothing in the file says in
/// which order and with which sign, and its readers do not agree (docs/reference/formats.md).
enum class CorVersion { k1, k2 };

/// Convention for the numbers of a .cor file. The default is as glase's source documents order and sign, with
/// cells of 1024 units.
struct CorConvention {
  enum class First { kDx, kDy };         ///< First number of a pair.
  enum class Fast { kX, kY };            ///< Axis that runs from one pair to the next.
  enum class Sense { kSubtract, kAdd };  ///< Error of the point, or offset of the aim.
  First first{First::kDy};
  Fast fast{Fast::kY};
  Sense sense{Sense::kSubtract};
  bool x_descends{false};
  bool y_descends{false};
  double units_per_cell{1024.0};  ///< Distance of two nodes; 65 nodes span the 16 bits.
  /// Scale in place of the file's, which may be a placeholder (1.0) or nonsense.
  std::optional<double> units_per_mm{};

  static CorConvention glase();     ///< dy first, y fast, subtracted, cells of 1000 units, 400 units/mm.
  static CorConvention meerk40t();  ///< Convention of its nine-point writer: dx first, x fast, subtracted.
  static CorConvention added();     ///< Convention of bilinear firmwares: dx first, x fast, added.
  /// Convention in words.
  [[nodiscard]] std::string text() const;
};

struct CorFile {
  CorVersion version{};
  double units_per_mm{};       ///< Units per mm that the grid was made with.
  double file_units_per_mm{};  ///< Units per mm that the file states.
  AimGrid grid;                ///< Bilinear; refused outside: a galvo does not leave its 16 bits.
};

/// Version of a .cor file by its label; nullopt if the label is none of JCZ's.
std::optional<CorVersion> corVersionOf(std::string_view bytes);

/// @throws TableFileError with every fault and its byte: label, size, scale out of 5 … 1e5 without
///   `units_per_mm` being given, values that are not finite or beyond ±32767.
CorFile parseCorFile(std::string_view bytes, const std::string& name, const CorConvention& convention = {});

/// The grid at the 65 x 65 places of a field, bytes as JCZ has them. v1 keeps fractions of a unit, which the
/// board rounds; v2 is rounded here.
/// @throws std::invalid_argument if `units_per_mm` is not given or out of 5 … 1e5, the grid says nothing
/// about
///   a place, or a value is beyond ±32767 units.
std::string corFile(const AimGrid& grid, CorVersion version, const CorConvention& convention);

}  // namespace kerfbench::calibrate
