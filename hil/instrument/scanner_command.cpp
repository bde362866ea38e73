// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/scanner_command.h"

#include <fmt/format.h>

#include <cstdio>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/camera/calibrate_camera.h"
#include "hil/calibrate/files/day.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/calibrate/scanner/scanner_file.h"
#include "hil/calibrate/scanner/scanner_fit.h"
#include "hil/camera/picture_file.h"

namespace kerfbench::instrument {
namespace {

int calibrate(const ScannerCommandOptions& options) {
  base::Console console(options.quiet);
  if (!calibrate::dayNumber(options.date))
    throw base::ConfigError(fmt::format("--date: {} is no day like 2026-11-21", options.date));
  const std::string id = options.id.empty() ? options.out.stem().string() : options.id;
  const calibrate::ScannerCalibration scanner =
      calibrate::calibrateScanner(camera::readPicture(options.scan),
                                  {calibrate::readTarget(options.target), id, options.date, options.dpi});
  const calibrate::ScannerMap& map = scanner.map;
  const double nominal_mm = 25.4 / options.dpi;
  base::writeFileAtomically(
      options.out,
      calibrate::scannerText(
          scanner, fmt::format("kerfbench calibrate scanner --scan {} --target {} --dpi {:g} --id {} "
                               "--date {}",
                               options.scan.filename().string(), options.target.filename().string(),
                               options.dpi, id, options.date)));
  console.say(fmt::format(
      "  {} corners; scale along the bar {:+.4f} %, along the carriage's way {:+.4f} %, out of square "
      "{:+.3f} mrad",
      scanner.corners, 100.0 * (map.mm_per_px(0, 0) / nominal_mm - 1.0),
      100.0 * (-map.mm_per_px(1, 1) / nominal_mm - 1.0), 1e3 * map.mm_per_px(0, 1) / map.mm_per_px(1, 1)));
  console.result(fmt::format("{}: residual {:.4f} mm, largest standard uncertainty of the map {:.4f} mm; {}",
                             id, scanner.rms_mm, scanner.map_u_mm, options.out.string()));
  return 0;
}

}  // namespace

int calibrateScannerCommand(const ScannerCommandOptions& options) {
  const auto refused = [](const std::string& why) {
    base::toTerminal(stderr, why + "\n");
    return base::kExitInput;
  };
  try {
    return calibrate(options);
  } catch (const base::ConfigError& error) {
    return refused(error.what());
  } catch (const calibrate::CalibrationError& error) {
    return refused(fmt::format("{}: {}\nno calibration is written", options.scan.string(), error.what()));
  }
}

}  // namespace kerfbench::instrument
