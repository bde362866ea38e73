// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kerfbench::app {

/// Says what a trace holds, and whether it is sound, in lines. Returns 0; 1 for one that is cut off or
/// damaged; base::kExitInput for what is no trace.
int traceInfoCommand(const std::filesystem::path& file);

/// A whole trace of what is there of one that was cut off.
struct TraceRecovery {
  std::filesystem::path file, out;
};
/// Returns 0, or base::kExitInput for what is no trace.
int traceRecoverCommand(const TraceRecovery& options);

/// A trace as a page that stands alone.
struct TracePage {
  std::filesystem::path file, out;
  std::optional<double> at_s;  ///< Where it opens; empty: at its begin.
  std::filesystem::path bin_dir;
};
/// Returns 0; base::kExitInput for what is no trace, or one that is too large for a page; base::kExitBroken
/// where the window was not built.
int tracePageCommand(const TracePage& options);

/// A part of a trace as a trace of its own.
struct TraceClip {
  std::filesystem::path file, out;
  double at_s{};
  double around_s{0.05};
};
/// Returns as traceRecoverCommand(); base::kExitInput also where nothing was recorded in that part.
int traceClipCommand(const TraceClip& options);

}  // namespace kerfbench::app
