// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/marks/field_marks.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/camera/tile_folder.h"
#include "hil/head_service/head_setup.h"

namespace kerfbench::head_service {

/// A mark that was found once.
struct MeasuredMark {
  calibrate::WantedMark wanted;
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};  ///< Measured place of the mark.
  /// Covariance of p_W_mm: its own, without that of the sheet's pose.
  Eigen::Matrix2d covariance_mm2{Eigen::Matrix2d::Identity()};

  [[nodiscard]] Eigen::Vector2d error_mm() const { return p_W_mm - wanted.p_W_mm; }
};

/// A sheet of a job, as its pictures show it.
struct MeasuredSheet {
  std::string digest;  ///< Digest of all that it depends on; see sheetOnTwin().
  std::vector<MeasuredMark> marks;
  /// Covariance of where the sheet was taken to lie: what that error shifts (x, y, mm) and turns (rad, about
  /// W's origin) all marks by.
  Eigen::Matrix3d pose_covariance{Eigen::Matrix3d::Zero()};
  int missing{};      ///< Wanted, not found.
  int false_marks{};  ///< Found more than once, or of no mark of the job.
  std::vector<std::string> remarks;
};

/// Distances of the marks of one sheet or several from where they were wanted.
struct SheetErrors {
  std::size_t marks{};
  double max_mm{}, rms_mm{};
};
SheetErrors errorsOf(std::span<const MeasuredSheet> sheets);

/// A job that was cut. @throws ConfigError with everything that is wrong; for another machine's.
calibrate::MarkJob readJobOf(const HeadSetup& setup, const std::filesystem::path& path);
/// Pictures of the machine's kerf camera. @throws ConfigError as TileFolder.
camera::TileFolder openPictures(const HeadSetup& setup, const std::filesystem::path& folder);

/// Finds the job's marks in the pictures. @throws HeadEvidenceError with every reason why they must not be
/// used.
MeasuredSheet measureSheet(camera::TileSource& tiles, const calibrate::MarkJob& job, const HeadSetup& setup,
                           int threads);
/// Finds them in the pictures of a folder, which the message names. @throws ConfigError for pictures that
/// cannot be read, or are of another camera's size.
MeasuredSheet measurePictures(const std::filesystem::path& folder, const calibrate::MarkJob& job,
                              const HeadSetup& setup, int threads);

/// Observations for the fit: aims are what the controller made of the wanted places with its table. `number`:
/// number of the sheet, unique in a fit.
/// @throws HeadEvidenceError for a mark outside of the table.
std::vector<calibrate::HeadObservation> observationsOf(const MeasuredSheet& sheet,
                                                       const std::optional<calibrate::AimGrid>& table,
                                                       int number);

/// Version of measuredText(); belongs into a digest of what was measured, so that what an older program wrote
/// is measured again.
inline constexpr int kMeasuredVersion = 2;
/// YAML of a sheet; numbers read back to the last bit.
std::string measuredText(const MeasuredSheet& sheet);
/// nullopt if there is no file, or one with another digest. @throws ConfigError with everything that is wrong
/// in one with this digest, each with file and line.
std::optional<MeasuredSheet> readMeasured(const std::filesystem::path& path, const calibrate::MarkJob& job,
                                          const std::string& digest);

}  // namespace kerfbench::head_service
