// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "hil/base/progress.h"

// What a page or another program asks the bench while somebody prepares a job: values and text go in, text in
// JSON comes out; nothing is written, and nothing is remembered from one call to the next, so that all
// functions may be called by several threads at a time. Text of foreign files (names of layers, say) travels
// as JSON strings and never as markup; bytes that are not UTF-8 become U+FFFD.
namespace kerfbench::desk {

/// Surroundings of a request.
struct DeskRequest {
  std::filesystem::path bin_dir;  ///< Folder of the programs; firmware and reference pages are found from it.
  /// Name by which the asker knows a file; empty: its path.
  std::function<std::string(const std::filesystem::path&)> name_of{};
  base::ProgressFn progress{};  ///< Told now and then while a request takes long.
};

/// A scenario as an editor holds it, saved or not.
struct ScenarioText {
  std::string text;
  /// Absolute path at which it lies or would be saved: the file names in it are relative to its folder.
  std::filesystem::path file;
};

}  // namespace kerfbench::desk
