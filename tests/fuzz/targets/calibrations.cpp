// SPDX-License-Identifier: Apache-2.0
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/calibration_file.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/scanner/scanner_file.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {

bool cameraCalibration(Bytes bytes) {
  return takes<base::ConfigError>(
      [&] { (void)calibrate::readCalibrationFile(asFile("camera.yaml", bytes)); });
}

bool calibrationTarget(Bytes bytes) {
  return takes<base::ConfigError>([&] { (void)calibrate::readTarget(asFile("target.yaml", bytes)); });
}

bool scannerCalibration(Bytes bytes) {
  return takes<base::ConfigError>([&] { (void)calibrate::readScannerFile(asFile("scanner.yaml", bytes)); });
}

bool markJob(Bytes bytes) {
  return takes<base::ConfigError>([&] { (void)calibrate::readMarkJob(asFile("job.yaml", bytes)); });
}

}  // namespace kerfbench::fuzz
