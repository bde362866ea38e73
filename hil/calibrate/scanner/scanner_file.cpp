// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/scanner/scanner_file.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/day.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kHuge_mm = 100.0;

std::string listOf(const Eigen::VectorXd& values) {
  return fmt::format("[{}]", fmt::join(values.data(), values.data() + values.size(), ", "));
}

Eigen::VectorXd vectorOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::string scannerText(const ScannerCalibration& scanner, const std::string& made_by) {
  const ScannerMap& map = scanner.map;
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Calibration of a flatbed scanner: millimetres on its glass of a pixel of the whole picture.\n"
      "# Made by: {}\n"
      "version: 1\n"
      "scanner_id: '{}'\n"
      "date: '{}'\n"
      "dpi: {}\n"
      "size_px: [{}, {}]   # Of the whole glass; scans of another size are refused.\n"
      "x_mm_per_px: {}   # Along the bar and along the carriage's way.\n"
      "y_mm_per_px: {}\n"
      "bar_x_mm: {}   # Legendre polynomials of degree 2 … 5 along the bar.\n"
      "bar_y_mm: {}\n"
      "splines: {}   # Cubic, of even knots, along the carriage's way.\n"
      "carriage_x_mm: {}\n"
      "carriage_y_mm: {}\n"
      "corners: {}\n"
      "rms_mm: {:.6g}\n"
      "map_u_mm: {:.6g}   # Largest standard uncertainty of a place.\n",
      made_by, scanner.scanner_id, scanner.date, scanner.dpi, map.width_px, map.height_px,
      listOf(map.mm_per_px.row(0).transpose()), listOf(map.mm_per_px.row(1).transpose()),
      listOf(map.bar_mm.row(0).transpose()), listOf(map.bar_mm.row(1).transpose()), map.carriage_mm.cols(),
      listOf(map.carriage_mm.row(0).transpose()), listOf(map.carriage_mm.row(1).transpose()), scanner.corners,
      scanner.rms_mm, scanner.map_u_mm);
}

ScannerCalibration readScannerFile(const std::filesystem::path& path) {
  auto file = base::YamlReader::openFile(path);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  ScannerCalibration scanner;
  ScannerMap& map = scanner.map;
  scanner.scanner_id = file.text("scanner_id");
  scanner.date = file.text("date");
  if (!dayNumber(scanner.date)) file.fault("date", "is no day like 2026-11-21");
  scanner.dpi = file.number("dpi", {.min = 100, .max = 4800});
  const auto size = file.numbers("size_px", 2, {.min = 100, .max = 1e5});
  map.width_px = static_cast<int>(size[0]);
  map.height_px = static_cast<int>(size[1]);
  const base::YamlReader::Range pitch{.min = -1.0, .max = 1.0}, any{.min = -kHuge_mm, .max = kHuge_mm};
  map.mm_per_px.row(0) = vectorOf(file.numbers("x_mm_per_px", 2, pitch)).transpose();
  map.mm_per_px.row(1) = vectorOf(file.numbers("y_mm_per_px", 2, pitch)).transpose();
  if (!(map.mm_per_px(0, 0) > 0.0 && map.mm_per_px(1, 1) < 0.0))
    file.fault("y_mm_per_px", "x must grow along the bar, y against the carriage's way");
  map.bar_mm.row(0) = vectorOf(file.numbers("bar_x_mm", ScannerMap::kBar, any)).transpose();
  map.bar_mm.row(1) = vectorOf(file.numbers("bar_y_mm", ScannerMap::kBar, any)).transpose();
  const auto splines = static_cast<std::size_t>(file.integer("splines", {.min = 4, .max = 1000}));
  map.carriage_mm.resize(2, static_cast<Eigen::Index>(splines));
  map.carriage_mm.row(0) = vectorOf(file.numbers("carriage_x_mm", splines, any)).transpose();
  map.carriage_mm.row(1) = vectorOf(file.numbers("carriage_y_mm", splines, any)).transpose();
  scanner.corners = static_cast<std::size_t>(file.integer("corners", {.min = 1, .max = 1e9}));
  scanner.rms_mm = file.number("rms_mm", {.min = 0, .max = 1});
  scanner.map_u_mm = file.number("map_u_mm", {.min = 1e-9, .max = 1});
  file.finish();
  return scanner;
}

}  // namespace kerfbench::calibrate
