// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// A first scenario for a drawing.
struct NewScenario {
  std::filesystem::path drawing;  ///< Absolute, .dxf, .svg, .cf2 or .pdf.
  std::filesystem::path machine;  ///< Absolute, a machine file.
  std::filesystem::path out;  ///< Absolute: where it would be saved; file names in it are relative to this.
};

/// Text of the scenario: a resting sheet with registration marks around the drawing, layers by the usual
/// names (every layer that has none of these is in it as `ignore` with a comment that says so), powers and
/// speeds that the machine can do, the native release, and a comment at each key that one may want to change.
/// @throws base::InputError, DielineError, ConfigError where drawing or machine cannot be used.
std::string firstScenario(const NewScenario& wish, const DeskRequest& request);

/// @throws base::InputError, DielineError where nothing of a drawing can be cut. Files that are no drawings
/// pass.
void refuseUncuttable(const std::filesystem::path& drawing, const DeskRequest& request);

}  // namespace kerfbench::desk
