// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/c_header.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "hil/base/digest.h"
#include "hil/calibrate/tables/c_header_numbers.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::size_t kPerLine = 12;

using Whole = CHeaderNumbers::Array;

std::string faultsOf(const CHeaderOptions& options, const AimGrid& grid) {
  std::string faults;
  const std::string& prefix = options.prefix;
  const auto good = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
  if (prefix.empty() || prefix.size() > 60 || !std::ranges::all_of(prefix, good) || prefix[0] < 'A' ||
      prefix[0] > 'Z')
    faults += "the prefix must be of capital letters, digits and '_', a letter first\n";
  const std::size_t bytes = options.value == CHeaderOptions::Value::kInt16 ? 2 : 4;
  const std::size_t largest =
      std::max({grid.d_mm().size() * bytes, grid.x_mm().size() * 4, grid.y_mm().size() * 4});
  if (largest > options.most_array_bytes) {
    faults += fmt::format("{} x {} nodes make an array of {} bytes, more than {}\n", grid.x_mm().size(),
                          grid.y_mm().size(), largest, options.most_array_bytes);
  }
  return faults;
}

double largestOf(const AimGrid& grid) {
  double largest = 0.0;
  for (const Eigen::Vector2d& d : grid.d_mm()) largest = std::max(largest, d.cwiseAbs().maxCoeff());
  return largest;
}

std::int64_t unitOf(const AimGrid& grid, const CHeaderOptions& options, double most) {
  if (options.unit_nm > 0) return options.unit_nm;
  if (options.value == CHeaderOptions::Value::kInt32) return 1;
  return static_cast<std::int64_t>(std::clamp(std::ceil(largestOf(grid) * kNmPerMm / most), 1.0, 1e9));
}

Whole placesIn_nm(const std::vector<double>& places, const char* axis, std::string& faults) {
  Whole whole;
  for (const double place : places) {
    if (std::abs(place) * kNmPerMm > std::numeric_limits<std::int32_t>::max()) {
      faults += fmt::format("{} {:g} mm is beyond int32 in nm\n", axis, place);
      return whole;
    }
    whole.push_back(std::llround(place * kNmPerMm));
    if (whole.size() > 1 && whole.back() <= whole[whole.size() - 2])
      faults += fmt::format("two places near {} {:g} mm round to the same nm\n", axis, place);
  }
  return whole;
}

CHeaderNumbers numbersOf(const AimGrid& grid, const CHeaderOptions& options) {
  std::string faults = faultsOf(options, grid);
  const double most = options.value == CHeaderOptions::Value::kInt16
                          ? std::numeric_limits<std::int16_t>::max()
                          : std::numeric_limits<std::int32_t>::max();
  CHeaderNumbers numbers;
  numbers.arrays[0] = placesIn_nm(grid.x_mm(), "x", faults);
  numbers.arrays[1] = placesIn_nm(grid.y_mm(), "y", faults);
  numbers.unit_nm = unitOf(grid, options, most);
  numbers.hermite = grid.between() == Between::kHermite ? 1 : 0;
  numbers.outside = static_cast<std::int64_t>(grid.outside());
  const double scale = kNmPerMm / static_cast<double>(numbers.unit_nm);
  if (largestOf(grid) * scale > most)
    faults += fmt::format("{:g} mm does not fit in units of {} nm\n", largestOf(grid), numbers.unit_nm);
  if (!faults.empty()) {
    faults.pop_back();
    throw std::invalid_argument(faults);
  }
  for (const Eigen::Vector2d& d : grid.d_mm()) {
    numbers.arrays[2].push_back(std::llround(d.x() * scale));
    numbers.arrays[3].push_back(std::llround(d.y() * scale));
  }
  return numbers;
}

std::string commentOf(const AimGrid& grid, const CHeaderNumbers& numbers, const std::string& prefix) {
  const bool hermite = grid.between() == Between::kHermite;
  const char* outside = grid.outside() == Outside::kRefused   ? "nothing: such a place is refused"
                        : grid.outside() == Outside::kClamped ? "the value of the nearest place on the border"
                                                              : "the surface of the outermost cell goes on";
  return fmt::format(
      "/* Correction of a scan head, {} x {} nodes.\n"
      " * A beam wanted at (x, y) is aimed at (x + dx, y + dy) in place of (x, y).\n"
      " * {}_X_NM, _Y_NM: places of columns and rows, nm in the sheet's plane, ascending; x along belt\n"
      " * travel, y across, (0, 0) under the resting beam. _DX, _DY: in units of {} nm, y ascending, and "
      "for\n"
      " * each y all x ascending.\n"
      " * Between nodes: {}.\n"
      " * Outside: {}.\n"
      " * On AVR the arrays lie in flash: pgm_read_word, pgm_read_dword, their _far kin beyond 64 KiB.\n"
      " */\n",
      grid.x_mm().size(), grid.y_mm().size(), prefix, numbers.unit_nm,
      hermite ? "bicubic Hermite, slopes from the polynomial through five neighbours" : "bilinear", outside);
}

std::string constantsOf(const CHeaderNumbers& numbers, const std::string& prefix) {
  return fmt::format(
      "#ifndef {0}_H\n"
      "#define {0}_H\n\n"
      "#include <stdint.h>\n\n"
      "#define {0}_COLUMNS {1}\n"
      "#define {0}_ROWS {2}\n"
      "#define {0}_UNIT_NM {3}\n"
      "#define {0}_HERMITE {4}\n"
      "#define {0}_OUTSIDE {5}\n"
      "#define {0}_SHA256 \"{6}\"\n\n"
      "#ifndef {0}_STORAGE\n"
      "#ifdef __AVR__\n"
      "#include <avr/pgmspace.h>\n"
      "#define {0}_STORAGE PROGMEM\n"
      "#else\n"
      "#define {0}_STORAGE\n"
      "#endif\n"
      "#endif\n",
      prefix, numbers.arrays[0].size(), numbers.arrays[1].size(), numbers.unit_nm, numbers.hermite,
      numbers.outside, hashOf(numbers));
}

}  // namespace

std::string listed(const CHeaderNumbers::Array& values, std::size_t per_line) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += i % per_line == 0 ? ",\n" : ", ";
    text += fmt::format("{}", values[i]);
  }
  return text;
}

std::string hashOf(const CHeaderNumbers& numbers) {
  std::string text = fmt::format("{}\n{}\n{}\n", numbers.unit_nm, numbers.hermite, numbers.outside);
  for (const CHeaderNumbers::Array& array : numbers.arrays)
    text += fmt::format("{}\n{}\n", array.size(), listed(array, 1));
  return base::sha256(text);
}

std::string cHeader(const AimGrid& grid, const CHeaderOptions& options) {
  const CHeaderNumbers numbers = numbersOf(grid, options);
  const std::string& prefix = options.prefix;
  const char* value = options.value == CHeaderOptions::Value::kInt16 ? "int16_t" : "int32_t";
  const std::string nodes = fmt::format("{0}_ROWS * {0}_COLUMNS", prefix);
  const std::array<std::string, 4> sizes{prefix + "_COLUMNS", prefix + "_ROWS", nodes, nodes};
  std::string text = commentOf(grid, numbers, prefix) + constantsOf(numbers, prefix);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    text += fmt::format("\nstatic const {} {}{}[{}] {}_STORAGE = {{\n{}\n}};\n", i < 2 ? "int32_t" : value,
                        prefix, kCHeaderArrays.at(i), sizes.at(i), prefix,
                        listed(numbers.arrays.at(i), kPerLine));
  }
  return text + "\n#endif\n";
}

}  // namespace kerfbench::calibrate
