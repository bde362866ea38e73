// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/cor_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in the file");

constexpr std::size_t kSide = 65;
constexpr std::size_t kPairs = kSide * kSide;
constexpr std::size_t kLabelBytes = 22;
constexpr double kLargestUnits = 32767.0;
constexpr double kLeastScale = 5.0;  // A field of 13 m.
constexpr double kMostScale = 1e5;
constexpr double kMostCell = 1024.0;

struct Layout {
  CorVersion version;
  std::string_view label;
  std::size_t scale_byte, table_byte, value_bytes;
  std::vector<std::size_t> tails;  // Bytes that may follow the table.
  [[nodiscard]] std::size_t size() const { return table_byte + 2 * kPairs * value_bytes; }
};

const Layout& layoutOf(CorVersion version) {
  static const std::array<Layout, 2> kLayouts{
      Layout{CorVersion::k1, "LMC1COR_1.0", 0x170, 0x210, sizeof(double), {0}},
      Layout{CorVersion::k2, "JCZ_COR_2_1", 0x1C, 0x24, sizeof(std::int32_t), {0, 4}}};
  return kLayouts.at(version == CorVersion::k1 ? 0 : 1);
}

std::string labelBytes(std::string_view label, bool wide) {
  std::string bytes;
  for (const char c : label) {
    bytes += c;
    if (wide) bytes += '\0';
  }
  bytes.resize(kLabelBytes, '\0');
  return bytes;
}

const Layout* layoutWithLabelOf(std::string_view bytes) {
  for (const CorVersion version : {CorVersion::k1, CorVersion::k2}) {
    const Layout& layout = layoutOf(version);
    for (const bool wide : {false, true}) {
      if (bytes.starts_with(labelBytes(layout.label, wide))) return &layout;
    }
  }
  return nullptr;
}

template <typename T>
double numberAt(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return static_cast<double>(value);
}

template <typename T>
void putNumber(std::string& bytes, T value) {
  std::array<char, sizeof value> raw{};
  std::memcpy(raw.data(), &value, sizeof value);
  bytes.append(raw.data(), raw.size());
}

/// Column and row, ascending in x and y, of the pair at `index` of the file.
std::pair<std::size_t, std::size_t> nodeAt(std::size_t index, const CorConvention& convention) {
  std::size_t column = index % kSide;
  std::size_t row = index / kSide;
  if (convention.fast == CorConvention::Fast::kY) std::swap(column, row);
  if (convention.x_descends) column = kSide - 1 - column;
  if (convention.y_descends) row = kSide - 1 - row;
  return {column, row};
}

/// From the pair in the file to the offset of the aim, and back.
Vector2d turned(const Vector2d& pair, const CorConvention& convention) {
  Vector2d d = convention.first == CorConvention::First::kDx ? pair : Vector2d(pair.y(), pair.x());
  if (convention.sense == CorConvention::Sense::kSubtract) d = Vector2d::Zero() - d;
  return d;
}

std::vector<double> fieldPlaces(const CorConvention& convention, double units_per_mm) {
  const double half_mm = 0.5 * static_cast<double>(kSide - 1) * convention.units_per_cell / units_per_mm;
  return evenly(-half_mm, half_mm, kSide);
}

std::string conventionFaults(const CorConvention& convention) {
  if (!(convention.units_per_cell >= 1.0 && convention.units_per_cell <= kMostCell))
    return fmt::format("cells are of 1 to {:g} units, not {:g}", kMostCell, convention.units_per_cell);
  const double scale = convention.units_per_mm.value_or(kLeastScale);
  if (!(scale >= kLeastScale && scale <= kMostScale))
    return fmt::format("a scale of {:g} units/mm is out of {:g} … {:g}", scale, kLeastScale, kMostScale);
  return {};
}

void checkSize(std::string_view bytes, const Layout& layout, TableFaults& faults) {
  for (const std::size_t tail : layout.tails) {
    if (bytes.size() == layout.size() + tail) return;
  }
  faults.atByte(std::min(bytes.size(), layout.size()),
                fmt::format("the file has {} bytes, a {} has {}", bytes.size(), layout.label, layout.size()));
  faults.throwIfAny();
}

double scaleOf(double in_file, const Layout& layout, const CorConvention& convention, TableFaults& faults) {
  if (convention.units_per_mm) return *convention.units_per_mm;
  if (in_file >= kLeastScale && in_file <= kMostScale) return in_file;
  faults.atByte(layout.scale_byte,
                fmt::format("the scale of {:g} units/mm is out of {:g} … {:g}: a placeholder? Say how many "
                            "units make 1 mm",
                            in_file, kLeastScale, kMostScale));
  return kLeastScale;
}

double valueAt(std::string_view bytes, std::size_t index, const Layout& layout, TableFaults& faults) {
  const std::size_t at = layout.table_byte + index * layout.value_bytes;
  const double value =
      layout.version == CorVersion::k1 ? numberAt<double>(bytes, at) : numberAt<std::int32_t>(bytes, at);
  if (!(std::abs(value) <= kLargestUnits)) {
    faults.atByte(at, fmt::format("{:g} units are beyond ±{:g}", value, kLargestUnits));
    return 0.0;
  }
  return value;
}

std::string head(const Layout& layout, double units_per_mm) {
  // meerk40t takes v1 for v2 unless its label is UTF-16LE; glase and Cor Tools want v2's in ASCII.
  std::string bytes = labelBytes(layout.label, layout.version == CorVersion::k1);
  bytes.resize(layout.scale_byte, '\0');
  putNumber(bytes, units_per_mm);
  bytes.resize(layout.table_byte, '\0');
  return bytes;
}

void putValue(std::string& bytes, double units, const Vector2d& p_mm, const Layout& layout) {
  if (!(std::abs(units) <= kLargestUnits)) {
    throw std::invalid_argument(fmt::format("{:.0f} units at ({:g}, {:g}) mm are beyond ±{:g}", units,
                                            p_mm.x(), p_mm.y(), kLargestUnits));
  }
  if (layout.version == CorVersion::k1) {
    putNumber(bytes, units);
  } else {
    putNumber(bytes, static_cast<std::int32_t>(std::lround(units)));
  }
}

}  // namespace

CorConvention CorConvention::glase() {
  CorConvention convention;
  convention.units_per_cell = 1000.0;
  convention.units_per_mm = 400.0;
  return convention;
}

CorConvention CorConvention::meerk40t() {
  CorConvention convention = added();
  convention.sense = Sense::kSubtract;
  return convention;
}

CorConvention CorConvention::added() {
  CorConvention convention;
  convention.first = First::kDx;
  convention.fast = Fast::kX;
  convention.sense = Sense::kAdd;
  return convention;
}

std::string CorConvention::text() const {
  return fmt::format("pairs ({}), {} runs fastest, x {}, y {}, {}, cells of {:g} units{}",
                     first == First::kDx ? "dx, dy" : "dy, dx", fast == Fast::kX ? "x" : "y",
                     x_descends ? "descends" : "ascends", y_descends ? "descends" : "ascends",
                     sense == Sense::kSubtract ? "how wrong the uncorrected point is, subtracted from the aim"
                                               : "offset of the aim, added",
                     units_per_cell, units_per_mm ? fmt::format(", {:g} units/mm", *units_per_mm) : "");
}

std::optional<CorVersion> corVersionOf(std::string_view bytes) {
  const Layout* layout = layoutWithLabelOf(bytes);
  return layout == nullptr ? std::nullopt : std::optional(layout->version);
}

CorFile parseCorFile(std::string_view bytes, const std::string& name, const CorConvention& convention) {
  TableFaults faults(name);
  if (const std::string wrong = conventionFaults(convention); !wrong.empty()) faults.ofFile(wrong);
  const Layout* layout = layoutWithLabelOf(bytes);
  if (layout == nullptr) {
    faults.atByte(0, "the label is neither LMC1COR_1.0 nor JCZ_COR_2_1");
    faults.raise();
  }
  faults.throwIfAny();
  checkSize(bytes, *layout, faults);
  const double in_file = numberAt<double>(bytes, layout->scale_byte);
  const double scale = scaleOf(in_file, *layout, convention, faults);
  std::vector<Vector2d> d_mm(kPairs);
  for (std::size_t index = 0; index < kPairs; ++index) {
    const double first = valueAt(bytes, 2 * index, *layout, faults);
    const double second = valueAt(bytes, 2 * index + 1, *layout, faults);
    const auto [column, row] = nodeAt(index, convention);
    d_mm[row * kSide + column] = turned({first, second}, convention) / scale;
  }
  faults.throwIfAny();
  const std::vector<double> places = fieldPlaces(convention, scale);
  return {layout->version, scale, in_file,
          AimGrid(places, places, std::move(d_mm), Between::kBilinear, Outside::kRefused)};
}

std::string corFile(const AimGrid& grid, CorVersion version, const CorConvention& convention) {
  if (!convention.units_per_mm)
    throw std::invalid_argument("a .cor file needs the board's units per mm: 65536 over its field");
  if (const std::string wrong = conventionFaults(convention); !wrong.empty())
    throw std::invalid_argument(wrong);
  const double scale = *convention.units_per_mm;
  const std::vector<double> places = fieldPlaces(convention, scale);
  const AimGrid nodes = resampled(grid, places, places, Between::kBilinear, Outside::kRefused);
  const Layout& layout = layoutOf(version);
  std::string bytes = head(layout, scale);
  for (std::size_t index = 0; index < kPairs; ++index) {
    const auto [column, row] = nodeAt(index, convention);
    // Exchange and sign are their own inverses.
    const Vector2d pair = turned(scale * nodes.d_mm(column, row), convention);
    const Vector2d p(places[column], places[row]);
    putValue(bytes, pair.x(), p, layout);
    putValue(bytes, pair.y(), p, layout);
  }
  bytes.resize(layout.size() + layout.tails.back(), '\0');
  return bytes;
}

}  // namespace kerfbench::calibrate
