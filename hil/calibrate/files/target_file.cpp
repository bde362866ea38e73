// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/target_file.h"

#include <fmt/format.h>

#include "hil/base/yaml_reader.h"

namespace kerfbench::calibrate {

std::string targetText(const CalibrationTarget& target) {
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Calibration target: docs/how-to/calibrate-a-camera.md. A chessboard with a marker of OpenCV's "
      "dictionary 5X5_1000 "
      "in\n"
      "# each white square. Measure the print over many squares, and correct square_mm and marker_mm.\n"
      "version: 1\n"
      "columns: {}\n"
      "rows: {}\n"
      "square_mm: {:.12g}\n"
      "marker_mm: {:.12g}\n",
      target.columns, target.rows, target.square_mm, target.marker_mm);
}

CalibrationTarget readTarget(const std::filesystem::path& path) {
  auto file = base::YamlReader::openFile(path);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  CalibrationTarget target;
  target.columns = static_cast<int>(file.integer("columns", {.min = 4, .max = 200}));
  target.rows = static_cast<int>(file.integer("rows", {.min = 4, .max = 200}));
  target.square_mm = file.number("square_mm", {.min = 0.1, .max = 1000});
  target.marker_mm = file.number("marker_mm", {.min = 0.04, .max = 800});
  file.finish();
  if (const std::string faults = target.faults(); !faults.empty())
    throw base::ConfigError(path.string() + ": " + faults);
  return target;
}

}  // namespace kerfbench::calibrate
