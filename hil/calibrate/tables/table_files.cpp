// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_files.h"

#include <array>
#include <cstdint>
#include <utility>

#include "hil/base/atomic_file.h"
#include "hil/base/input_file.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/calibrate/tables/grid_text.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{128} << 20U;
constexpr std::size_t kMarkWithin = 4096;  // Bytes from the file's begin on in which its mark must stand.

constexpr std::array<std::pair<TableFormat, const char*>, 6> kNames{
    {{TableFormat::kCsv, "csv"},
     {TableFormat::kCHeader, "c-header"},
     {TableFormat::kCor1, "cor1"},
     {TableFormat::kCor2, "cor2"},
     {TableFormat::kGridText, "grid-text"},
     {TableFormat::kNinePoints, "nine-points"}}};

std::string bytesOf(const std::filesystem::path& path) {
  TableFaults faults(path.string());
  base::InputContent content = base::readInput(path, kMostBytes);
  if (!content.bytes) faults.ofFile(content.refusal);
  faults.throwIfAny();
  return *std::move(content.bytes);
}

AimGrid parsed(const std::string& bytes, TableFormat format, const std::string& name,
               const TableOptions& options) {
  switch (format) {
    case TableFormat::kCHeader:
      return parseCHeader(bytes, name);
    case TableFormat::kCor1:
    case TableFormat::kCor2:
      return parseCorFile(bytes, name, options.cor).grid;
    case TableFormat::kGridText:
      return parseGridText(bytes, name);
    case TableFormat::kNinePoints:
      return parseNinePointText(bytes, name, options.nine_points);
    case TableFormat::kCsv:
      break;
  }
  return parseCsvTable(bytes, name);
}

std::string written(const AimGrid& grid, TableFormat format, const TableOptions& options) {
  switch (format) {
    case TableFormat::kCHeader:
      return cHeader(grid, options.c_header);
    case TableFormat::kCor1:
      return corFile(grid, CorVersion::k1, options.cor);
    case TableFormat::kCor2:
      return corFile(grid, CorVersion::k2, options.cor);
    case TableFormat::kGridText:
      return gridText(grid);
    case TableFormat::kNinePoints:
      return ninePointText(grid, options.nine_points);
    case TableFormat::kCsv:
      break;
  }
  return csvTable(grid);
}

}  // namespace

const char* nameOf(TableFormat format) {
  for (const auto& [known, name] : kNames) {
    if (known == format) return name;
  }
  return "";
}

std::optional<TableFormat> tableFormat(const std::string& name) {
  for (const auto& [format, known] : kNames) {
    if (name == known) return format;
  }
  return std::nullopt;
}

std::optional<TableFormat> formatOf(std::string_view bytes) {
  if (const auto version = corVersionOf(bytes))
    return *version == CorVersion::k1 ? TableFormat::kCor1 : TableFormat::kCor2;
  static constexpr std::array<std::pair<std::string_view, TableFormat>, 4> kMarks{
      {{"x_mm,y_mm,", TableFormat::kCsv},
       {"#include <stdint.h>", TableFormat::kCHeader},
       {"; grid-text:", TableFormat::kGridText},
       {"# nine points:", TableFormat::kNinePoints}}};
  const std::string_view begin = bytes.substr(0, kMarkWithin);
  for (const auto& [mark, format] : kMarks) {
    if (begin.find(mark) != std::string_view::npos) return format;
  }
  return std::nullopt;
}

TableFile readTableFile(const std::filesystem::path& path, const TableOptions& options,
                        std::optional<TableFormat> format) {
  const std::string bytes = bytesOf(path);
  if (!format) format = formatOf(bytes);
  if (!format) {
    TableFaults faults(path.string());
    faults.ofFile("which format this is cannot be told from its content, say it");
    faults.throwIfAny();
  }
  return {*format, parsed(bytes, *format, path.string(), options)};
}

AimGrid readTable(const std::filesystem::path& path, const TableOptions& options,
                  std::optional<TableFormat> format) {
  return readTableFile(path, options, format).grid;
}

TableLoss formatLoss(TableFormat format, const AimGrid& grid, const TableOptions& options) {
  return tableLoss(grid, parsed(written(grid, format, options), format, nameOf(format), options));
}

TableLoss writeTable(const std::filesystem::path& path, TableFormat format, const AimGrid& grid,
                     const TableOptions& options) {
  const std::string bytes = written(grid, format, options);
  const TableLoss loss = tableLoss(grid, parsed(bytes, format, path.string(), options));
  base::writeFileAtomically(path, bytes);
  return loss;
}

}  // namespace kerfbench::calibrate
