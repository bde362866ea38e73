// SPDX-License-Identifier: Apache-2.0
// Calibrations in fixtures/machines: good for a micrometre, and equal to the command's results.
#include <gtest/gtest.h>

#include "hil/calibrate/files/calibration_file.h"
#include "hil/instrument/calibrate_command.h"
#include "hil/scenario/camera_files.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/calibrate/small_camera.h"

namespace kerfbench::calibrate {
namespace {

TEST(CommittedCalibrations, MisplaceNoPointByAMicrometre) {
  for (const char* name : {"two-mirror", "strip-gantry", "f-theta-300", "two-mirror-stepper",
                           "two-mirror-linecutter", "two-mirror-slow", "two-mirror-fast", "two-mirror-100",
                           "two-mirror-300", "two-mirror-800", "f-theta-300-mounted"}) {
    const machine_file::MachineFile file =
        machine_file::readMachineFile(base::fixture("machines/" + std::string(name) + ".yaml"));
    for (const auto& [camera, named] : {std::pair(file.machine.spot_camera, file.spot_camera),
                                        std::pair(file.machine.kerf_camera, file.kerf_camera)}) {
      const CalibrationFile kept = readCalibrationFile(named.calibration);
      EXPECT_EQ(kept.described_camera, scenario::cameraFingerprint(camera)) << name;
      EXPECT_EQ(kept.calibration.camera_id, named.id) << name;
      const double most_mm = test::largest(test::mapErrors(kept.calibration, test::truthOf(camera), 60));
      RecordProperty(std::string(name) + "_" + named.id + "_um", std::to_string(1e3 * most_mm));
      EXPECT_LT(most_mm, 0.001) << name << " " << named.id;
      // The error is within the stated one: the largest of many points is some 4 sigma of the worst one at
      // most.
      EXPECT_LT(most_mm, 4.0 * kept.calibration.map_u_mm) << name << " " << named.id;
      EXPECT_LT(kept.calibration.map_u_mm, 0.0005) << name;
    }
  }
}

TEST(CommittedCalibrations, AreWhatTheCommandMakes) {
  const base::TempFolder temp;
  instrument::CalibrateOptions options;
  options.machine = base::fixture("machines/two-mirror.yaml");
  options.camera = "kerf";
  options.date = "2026-11-20";
  options.jobs = 2;
  options.quiet = true;
  options.out = temp.path() / "kerf.yaml";
  options.picture = temp.path() / "kerf.svg";
  ASSERT_EQ(instrument::calibrateCameraCommand(options), 0);
  EXPECT_EQ(base::contentOf(options.out),
            base::contentOf(base::fixture("machines/two-mirror.kerf.camera.yaml")));
}

}  // namespace
}  // namespace kerfbench::calibrate
