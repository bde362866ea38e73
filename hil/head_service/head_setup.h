// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/nominal_head.h"
#include "hil/calibrate/tables/aim_grid.h"
#include "hil/machine_file/machine_file.h"
#include "hil/vision/image/camera_calibration.h"

namespace kerfbench::head_service {

/// Pictures or marks that must not be used; every reason, a line each.
class HeadEvidenceError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Knowledge of a head before anything is measured, and of how its marks are made.
/// Thickness of the board that marks are cut in.
inline constexpr double kMarkBoard_mm = 0.25;

struct HeadSetup {
  std::filesystem::path machine;     ///< Absolute path of the machine file.
  std::string name;                  ///< Name of the machine.
  vision::CameraCalibration camera;  ///< Identity and calibration of the kerf camera.
  calibrate::NominalHead nominal;    ///< The controller's formula.
  /// Head by its data sheet, as the controller is configured, with the drawing of the mirrors, and of the
  /// lens its focal length alone.
  calibrate::HeadDesign design;
  Eigen::AlignedBox2d controller_W_mm;  ///< The controller's whole field, which a table must cover.
  /// Field in which centres of marks may lie, so that whole marks stay in the field above.
  Eigen::AlignedBox2d field_W_mm;
  double mark_size_mm{};
  double beam_radius_mm{};  ///< 1/e².
  double open_gray{};       ///< Back light of the kerf camera, as it was set up.
  double table_sigma_mm{};  ///< Repeatability of the inspection table, per axis.
  double off_mm{};          ///< Largest error of the uncorrected beam, for which room is left.
  std::optional<calibrate::AimGrid> table;  ///< The machine's own so far.
  std::filesystem::path table_file;         ///< Empty: none.
  std::string digest;                       ///< Digest of all files that say so.
  /// Calibration of the scanner that sheets cut by hand are scanned with; empty: none is told.
  std::filesystem::path scanner_file;
  /// Error of encoders, lens and board beyond the model, HeadTolerances::unmodelled_share.
  double unmodelled_share{calibrate::HeadTolerances{}.unmodelled_share};
};

/// Marks are as large as a grid of `densest` x `densest` leaves room for. The table is `table_file`, or the
/// one that the machine file names. @throws ConfigError with everything wrong in the files, for a gantry, and
/// for a grid that leaves no room; HeadEvidenceError for a camera without a good calibration.
HeadSetup readHeadSetup(const std::filesystem::path& machine, int densest,
                        const std::filesystem::path& table_file = {});

/// @throws ConfigError with every fault of the file.
calibrate::AimGrid readControllerTable(const std::filesystem::path& path);

}  // namespace kerfbench::head_service
