// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/marks/mark_job.h"

namespace kerfbench::calibrate {

/// YAML of a job, with a digest over its content.
std::string markJobText(const MarkJob& job);
/// Digest of a job, 64 hex digits, for files that are made from it.
std::string markJobDigest(const MarkJob& job);
/// Cuts of a job as DXF (R12, mm, layer CUT) with nine decimals; the same bytes for the same job.
std::string markJobDxf(const MarkJob& job);

/// Writes PATH (YAML) and the drawing next to it, with the extension .dxf; the drawing first, so that no job
/// is without one. @throws std::invalid_argument with all faults of the job; std::system_error.
void writeMarkJob(const std::filesystem::path& path, const MarkJob& job);

/// @throws ConfigError with everything that is wrong, each with file and line: values, numbers twice, marks
/// that touch; and a digest that does not fit, for a file that was changed.
MarkJob readMarkJob(const std::filesystem::path& path);

}  // namespace kerfbench::calibrate
