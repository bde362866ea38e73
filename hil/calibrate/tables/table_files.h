// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/calibrate/tables/c_header.h"
#include "hil/calibrate/tables/cor_file.h"
#include "hil/calibrate/tables/nine_points.h"
#include "hil/calibrate/tables/table_faults.h"
#include "hil/calibrate/tables/table_loss.h"

namespace kerfbench::calibrate {

enum class TableFormat { kCsv, kCHeader, kCor1, kCor2, kGridText, kNinePoints };

/// "csv", "c-header", "cor1", "cor2", "grid-text", "nine-points".
const char* nameOf(TableFormat format);
std::optional<TableFormat> tableFormat(const std::string& name);

struct TableOptions {
  CorConvention cor{};
  NinePointOptions nine_points{};
  CHeaderOptions c_header{};
};

/// Format of a file by its content: a .cor by its label, a CSV by its header line, the others by the first
/// lines that the bench writes. nullopt for text grids and nine points of others, which look alike.
std::optional<TableFormat> formatOf(std::string_view bytes);

/// A table, and the format that its file is in.
struct TableFile {
  TableFormat format{};
  AimGrid grid;
};
/// @throws TableFileError with every fault; also if the file cannot be read, is above 128 MiB, or tells no
///   format and none is given.
TableFile readTableFile(const std::filesystem::path& path, const TableOptions& options = {},
                        std::optional<TableFormat> format = std::nullopt);
/// Table of a file in any format. @throws as readTableFile().
AimGrid readTable(const std::filesystem::path& path, const TableOptions& options = {},
                  std::optional<TableFormat> format = std::nullopt);

/// Loss by a format: the bytes that writeTable() would write, read back and compared with the original.
/// @throws std::invalid_argument if the format cannot hold the table.
TableLoss formatLoss(TableFormat format, const AimGrid& grid, const TableOptions& options = {});

/// Writes the file, whole or not at all, and says what the format cost, see formatLoss().
/// @throws std::invalid_argument if the format cannot hold the table; std::system_error.
TableLoss writeTable(const std::filesystem::path& path, TableFormat format, const AimGrid& grid,
                     const TableOptions& options = {});

}  // namespace kerfbench::calibrate
