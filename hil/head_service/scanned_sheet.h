// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/marks/mark_job.h"
#include "hil/head_service/head_setup.h"
#include "hil/head_service/measured_sheet.h"

namespace kerfbench::head_service {

/// A sheet as one picture of a flatbed scanner, in place of the kerf camera's:
///
///     scan.png, scan.jpg   the whole glass, the sheet face down with its +x along the sensor bar
///     scan.yaml            version: 1
///                          lid: black               # what is behind the sheet: black or white
///                          scanner: scanner.yaml    # `calibrate scanner` wrote it; from this file's folder
///                          dpi: 600                 # in place of a scanner's calibration, taken on trust
///
inline constexpr const char* kScanList = "scan.yaml";
/// The scan that a folder has; empty: none.
std::filesystem::path scanIn(const std::filesystem::path& folder);

/// scan.yaml to be completed by whoever scans. `scanner_file`: as HeadSetup.
std::string scanTemplate(const std::filesystem::path& scanner_file);

/// Finds the job's marks in the scan. The scanner's own uncertainty counts as one of each mark's place;
/// without a calibration that is what carriages are off by, 50 um, and the sheet says so.
/// @throws HeadEvidenceError for a scan that cannot be used: another resolution or size, a sheet that is
/// turned, cut off or another's; ConfigError for files that cannot be read.
MeasuredSheet measureScan(const std::filesystem::path& folder, const calibrate::MarkJob& job,
                          const HeadSetup& setup, int threads);
}  // namespace kerfbench::head_service
