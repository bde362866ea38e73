// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/calibrate/marks/mark_job.h"

namespace kerfbench::calibrate {

/// The job as YAML, with a digest over all that it says.
std::string markJobText(const MarkJob& job);
/// The job's digest: 64 hex digits, for files that are made from it.
std::string markJobDigest(const MarkJob& job);
/// Its cuts as DXF (R12, mm, layer CUT) with nine decimals; the same bytes for the same job.
std::string markJobDxf(const MarkJob& job);

/// Writes PATH (YAML) and, beside it, the drawing with the extension .dxf; the drawing first, so that a job
/// is there only with it. @throws std::invalid_argument with all faults of the job; std::system_error.
void writeMarkJob(const std::filesystem::path& path, const MarkJob& job);

/// @throws ConfigError with everything that is wrong, each with file and line: values, numbers twice, marks
/// that touch; and a digest that does not fit, for a file that was changed.
MarkJob readMarkJob(const std::filesystem::path& path);

}  // namespace kerfbench::calibrate
