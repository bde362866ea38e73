// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/base/console.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::live {

/// A real sheet is cut once: where its run cannot be concluded, what was recorded of it is put into a folder
/// as `capture` makes one, for a replay. NAME-capture below `results_dir`; -2 and so on behind it where there
/// is one, which may be evidence as well. Says where it is, or why it could not be kept.
/// @param frames recording of a real spot camera, which is moved there if it is whole; empty: none.
void salvageEvidence(const scenario::Case& test_case, const source::PinRecording& recording,
                     const std::filesystem::path& frames, const std::filesystem::path& results_dir,
                     base::Console& console) noexcept;

}  // namespace kerfbench::live
