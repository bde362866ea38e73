// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kerfbench::trace {

/// So long before and after a moment its page shows.
inline constexpr double kClipAround_s = 0.05;

/// The page of the window that stands alone, beside the programs; it is there once the window was built.
std::filesystem::path clipPage(const std::filesystem::path& bin_dir);

/// What a page is headed by.
struct ClipTitle {
  std::string title;               ///< Any text.
  std::optional<double> moment_s;  ///< Where it opens; empty: at its begin.
};
/// Writes a page that shows a trace and needs nothing else, neither a server nor a network: the window's page
/// with all of the trace in it. Whole or not at all. @throws base::InputError if `page` is none of the
/// window's, std::system_error with the path.
void writeClipPage(const std::filesystem::path& page, const std::filesystem::path& trace,
                   const ClipTitle& title, const std::filesystem::path& out);

}  // namespace kerfbench::trace
