// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/table_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "hil/base/console.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/tables/recognise.h"
#include "hil/calibrate/tables/table_files.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::instrument {
namespace {

using Eigen::Vector2d;

constexpr int kExitOtherwise = 1;
constexpr int kExitNotTold = 4;
constexpr double kCheckAt = 0.8;  // Share of the distance to a side at which nine marks are usually put.
constexpr double kOffTheGrid =
    0.07;  // no three of them in line with (0, 0), so that no mirror maps them on themselves
constexpr double kCorHalfCells = 32.0;  // 65 x 65 nodes

calibrate::CorConvention corConvention(const TableCommandOptions& options) {
  calibrate::CorConvention convention;
  if (options.cor == "glase") convention = calibrate::CorConvention::glase();
  if (options.cor == "meerk40t") convention = calibrate::CorConvention::meerk40t();
  if (options.cor == "added") convention = calibrate::CorConvention::added();
  if (options.units_per_mm) convention.units_per_mm = options.units_per_mm;
  return convention;
}

calibrate::TableOptions tableOptions(const TableCommandOptions& options) {
  calibrate::TableOptions table;
  table.cor = corConvention(options);
  table.nine_points.mm_per_index = options.mm_per_index;
  table.c_header.prefix = options.prefix;
  if (options.wide) table.c_header.value = calibrate::CHeaderOptions::Value::kInt32;
  return table;
}

double nearestSide_mm(const calibrate::AimGrid& grid) {
  return std::min({-grid.x_mm().front(), grid.x_mm().back(), -grid.y_mm().front(), grid.y_mm().back()});
}

/// For writing: what the user leaves open follows from the table. A .cor spans its 65 nodes over the largest
/// square in the table.
calibrate::TableOptions toWrite(const TableCommandOptions& options, calibrate::TableFormat format,
                                const calibrate::AimGrid& grid) {
  calibrate::TableOptions table = tableOptions(options);
  const bool cor = format == calibrate::TableFormat::kCor1 || format == calibrate::TableFormat::kCor2;
  if (cor && !table.cor.units_per_mm && nearestSide_mm(grid) > 0.0)
    table.cor.units_per_mm = kCorHalfCells * table.cor.units_per_cell / nearestSide_mm(grid);
  return table;
}

/// What the numbers mean; what lies between nodes and outside is the table's own.
std::string conventionOf(calibrate::TableFormat format, const calibrate::TableOptions& options,
                         const calibrate::AimGrid& grid) {
  const std::string cor = options.cor.text() + " (said by nothing in the file)";
  const std::string numbers =
      format == calibrate::TableFormat::kCHeader    ? "whole nm, and units of nm, in W; added to the aim"
      : format == calibrate::TableFormat::kGridText ? "mm in W; desired less measured, added to the aim"
      : format == calibrate::TableFormat::kNinePoints
          ? "mm in W; how wrong the uncorrected point is, subtracted from the aim"
      : format == calibrate::TableFormat::kCsv ? "mm in W; added to the aim"
                                               : cor;
  const bool three = grid.x_mm().size() == 3 && grid.y_mm().size() == 3;
  const char* between = grid.between() == calibrate::Between::kBilinear ? "bilinear"
                        : three                                         ? "biquadratic"
                                                                        : "bicubic Hermite";
  const char* outside = grid.outside() == calibrate::Outside::kRefused   ? "refused"
                        : grid.outside() == calibrate::Outside::kClamped ? "as the border"
                                                                         : "linear";
  return fmt::format("{}; {} between nodes; outside {}", numbers, between, outside);
}

std::string rangeOf(const calibrate::AimGrid& grid, int axis) {
  double low = grid.d_mm().front()[axis];
  double high = low;
  for (const Vector2d& d : grid.d_mm()) {
    low = std::min(low, d[axis]);
    high = std::max(high, d[axis]);
  }
  return fmt::format("d{} {:.4f} … {:.4f} mm", "xy"[axis], low, high);
}

/// Nine spots as this table would have them, no three in line with the middle.
std::vector<calibrate::UncorrectedSpot> ownSpots(const calibrate::AimGrid& grid) {
  std::vector<calibrate::UncorrectedSpot> spots;
  const double half_mm = kCheckAt * nearestSide_mm(grid);
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      const Vector2d p = half_mm * Vector2d(column + kOffTheGrid * row, row - 0.5 * kOffTheGrid * column);
      if (const auto d = grid.at_mm(p)) spots.push_back({p + *d, p});
    }
  }
  return spots;
}

/// Whether a check by nine marks would find out that this table is read the wrong way round.
std::string asymmetryOf(const calibrate::AimGrid& grid, double sigma_mm) {
  try {
    const calibrate::Recognition found = calibrate::recognise(grid, ownSpots(grid), {.sigma_mm = sigma_mm});
    if (found.verdict == calibrate::Recognition::Verdict::kAsRead)
      return fmt::format(
          "nine marks measured to {:g} mm would tell it from all readings that are another table", sigma_mm);
  } catch (const std::invalid_argument& error) {
    return fmt::format("no check by nine marks: {}", error.what());
  }
  return fmt::format(
      "too symmetrical, or too small, for nine marks measured to {:g} mm to tell how it is to be read",
      sigma_mm);
}

void tell(const calibrate::TableFile& table, const TableCommandOptions& options, base::Console& console) {
  const calibrate::AimGrid& grid = table.grid;
  const auto largest = std::ranges::max_element(grid.d_mm(), {}, [](const Vector2d& d) { return d.norm(); });
  const auto at = static_cast<std::size_t>(largest - grid.d_mm().begin());
  const std::size_t columns = grid.x_mm().size();
  console.say(fmt::format("{}: {}", options.file.string(), calibrate::nameOf(table.format)));
  console.say("  convention  " + conventionOf(table.format, tableOptions(options), grid));
  console.say(fmt::format("  nodes       {} x {}, x {:.4f} … {:.4f} mm, y {:.4f} … {:.4f} mm", columns,
                          grid.y_mm().size(), grid.x_mm().front(), grid.x_mm().back(), grid.y_mm().front(),
                          grid.y_mm().back()));
  console.say(fmt::format("  correction  {}, {}; {:.4f} mm at most, at ({:.4f}, {:.4f}) mm", rangeOf(grid, 0),
                          rangeOf(grid, 1), largest->norm(), grid.x_mm()[at % columns],
                          grid.y_mm()[at / columns]));
  const calibrate::TableLoss loss =
      calibrate::formatLoss(table.format, grid, toWrite(options, table.format, grid));
  console.say(fmt::format("  self-test   written and read back it differs by {:.6f} µm at most; {}",
                          loss.anywhere.max_um, asymmetryOf(grid, options.sigma_mm)));
}

std::vector<calibrate::UncorrectedSpot> spotsOf(const TableCommandOptions& options) {
  calibrate::TableOptions table;
  table.nine_points.mm_per_index = options.mm_per_index;
  const calibrate::AimGrid check =
      calibrate::readTable(options.check, table, calibrate::TableFormat::kNinePoints);
  std::vector<calibrate::UncorrectedSpot> spots;
  for (std::size_t row = 0; row < check.y_mm().size(); ++row) {
    for (std::size_t column = 0; column < check.x_mm().size(); ++column) {
      const Vector2d aim(check.x_mm()[column], check.y_mm()[row]);
      spots.push_back({aim, aim - check.d_mm(column, row)});
    }
  }
  return spots;
}

/// The table as it is to be used, and what to return if it is not to be used at all.
struct Checked {
  calibrate::AimGrid grid;
  bool righted{};
  int exit_code{};
};

Checked checked(const calibrate::AimGrid& grid, const TableCommandOptions& options, base::Console& console) {
  if (options.check.empty()) return {grid, false, 0};
  calibrate::Recognition found;
  try {
    found = calibrate::recognise(grid, spotsOf(options), {.sigma_mm = options.sigma_mm});
  } catch (const std::invalid_argument& error) {
    throw base::ConfigError(fmt::format("{}: {}", options.check.string(), error.what()));
  }
  console.result(fmt::format("{}: {}", options.file.string(), found.text));
  switch (found.verdict) {
    case calibrate::Recognition::Verdict::kAsRead:
      return {grid, false, 0};
    case calibrate::Recognition::Verdict::kOtherwise:
      return {calibrate::asRead(grid, found.reading), true, options.out.empty() ? kExitOtherwise : 0};
    case calibrate::Recognition::Verdict::kUndecided:
      return {grid, false, kExitNotTold};
    case calibrate::Recognition::Verdict::kNoneFits:
      break;
  }
  return {grid, false, kExitOtherwise};
}

calibrate::AimGrid withNodes(const calibrate::AimGrid& grid, const TableCommandOptions& options) {
  if (options.columns == 0) return grid;
  const auto axis = [](const std::vector<double>& from, int count) {
    return calibrate::evenly(from.front(), from.back(), static_cast<std::size_t>(count));
  };
  // Hermite needs three each way.
  const bool hermite =
      grid.between() == calibrate::Between::kHermite && std::min(options.columns, options.rows) >= 3;
  return calibrate::resampled(grid, axis(grid.x_mm(), options.columns), axis(grid.y_mm(), options.rows),
                              hermite ? calibrate::Between::kHermite : calibrate::Between::kBilinear,
                              grid.outside());
}

void tellSize(const calibrate::AimGrid& grid, const TableCommandOptions& options, base::Console& console) {
  const std::size_t value_bytes = options.wide ? 4 : 2;
  const std::size_t places = 4 * (grid.x_mm().size() + grid.y_mm().size());
  console.say(fmt::format("  {} bytes of flash: places {}, values 2 x {}",
                          places + 2 * value_bytes * grid.d_mm().size(), places,
                          value_bytes * grid.d_mm().size()));
}

void write(const Checked& table, const TableCommandOptions& options, base::Console& console) {
  const calibrate::TableFormat format = calibrate::tableFormat(options.to).value();
  const calibrate::AimGrid grid = withNodes(table.grid, options);
  const calibrate::TableOptions how = toWrite(options, format, grid);
  calibrate::writeTable(options.out, format, grid, how);
  const calibrate::AimGrid written = calibrate::readTable(options.out, how, format);
  // Against the table as it was, coarser nodes included.
  const calibrate::TableLoss loss = calibrate::tableLoss(table.grid, written);
  console.result(fmt::format("{}: {}{}", options.out.string(), options.to, table.righted ? ", righted" : ""));
  console.say("  convention  " + conventionOf(format, how, written));
  if (format == calibrate::TableFormat::kCHeader) tellSize(grid, options, console);
  console.say("  what it costs, where the beam lands beside:");
  std::istringstream lines(loss.text());
  for (std::string line; std::getline(lines, line);) console.say("    " + line);
}

int table(const TableCommandOptions& options) {
  base::Console console(options.quiet);
  const auto format = options.format.empty() ? std::nullopt : calibrate::tableFormat(options.format);
  const calibrate::TableFile file = calibrate::readTableFile(options.file, tableOptions(options), format);
  tell(file, options, console);
  const Checked found = checked(file.grid, options, console);
  if (options.out.empty()) return found.exit_code;
  if (found.exit_code != 0) {
    console.say(options.out.string() + " is not written");
    return found.exit_code;
  }
  write(found, options, console);
  return 0;
}

}  // namespace

int calibrateTableCommand(const TableCommandOptions& options) {
  return cli::runGuarded(options.file, [&] {
    try {
      return table(options);
    } catch (const calibrate::TableFileError& error) {
      throw base::ConfigError(error.what());
    } catch (const std::invalid_argument& error) {  // A format that cannot hold it.
      throw base::ConfigError(
          fmt::format("{}: {}", (options.out.empty() ? options.file : options.out).string(), error.what()));
    }
  });
}

}  // namespace kerfbench::instrument
