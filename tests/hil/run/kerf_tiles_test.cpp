// SPDX-License-Identifier: Apache-2.0
// What is not known of the inspection's scale, as the marks of an uncut sheet show it.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "hil/run/cut_on_twin.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"
#include "hil/vision/scan/kerf_scan.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::run {
namespace {

class KerfTiles : public testing::Test {
 protected:
  KerfTiles()
      : test_case(scenario::readCase(base::fixture("scenarios/native/label-on-belt.yaml"),
                                     images.write("controller-native", "").parent_path())),
        sheet(test_case.scenario.board),
        machine(test_case.machine) {
    test_case.scenario.print.units = 1;
  }

  /// RMS of the marks against the best rigid place of the print, as the bench measures it.
  double residualMm() const {
    camera::TwinTileSource tiles = kerfTiles(test_case, machine, sheet, {.threads = 2});
    EXPECT_GT(tiles.size(), 1U);
    const auto cameras = scenario::readCalibrations(test_case);
    vision::KerfScanOptions options;
    options.threads = 2;
    // Marks that fit the print badly are what is looked for here.
    options.print_sigma_mm = 0.1;
    const vision::KerfScan scan =
        vision::scanKerf(tiles, cameras.kerf.value(), test_case.scenario.print, *test_case.dieline, options);
    return scan.units.empty() ? NAN : scan.units.front().residual_mm;
  }
  /// What it is where all distances are longer by this share.
  double expectedMm(double share) const {
    const auto& marks = test_case.scenario.print.marks;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const RegistrationMark& mark : marks) middle += mark.p_SM_mm / static_cast<double>(marks.size());
    double squares = 0.0;
    for (const RegistrationMark& mark : marks) squares += (mark.p_SM_mm - middle).squaredNorm();
    return share * std::sqrt(squares / static_cast<double>(marks.size()));
  }

  const base::TempFolder images;  // No release is run here.
  scenario::Case test_case;
  twin::Sheet sheet;
  twin::MachineDescription machine;
};

constexpr double kShare = 1e-3;

TEST_F(KerfTiles, AnUncutSheetFitsItsPrint) { EXPECT_LT(residualMm(), 0.05 * expectedMm(kShare)); }

TEST_F(KerfTiles, BoardThatHasGrownNoLongerFitsIt) {
  machine.board_lot.swelling = kShare;
  EXPECT_NEAR(residualMm(), expectedMm(kShare), 0.1 * expectedMm(kShare));
}

// The table goes farther for each of its millimetres, and the camera's own scale is off by as much: together
// the same as board that has grown.
TEST_F(KerfTiles, ScalesOfTableAndTargetLookAlike) {
  machine.inspection_table.scale = -kShare;
  machine.kerf_camera.fx_px *= 1.0 + kShare;
  machine.kerf_camera.fy_px *= 1.0 + kShare;
  EXPECT_NEAR(residualMm(), expectedMm(kShare), 0.1 * expectedMm(kShare));
}

}  // namespace
}  // namespace kerfbench::run
