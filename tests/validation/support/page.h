// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/validation/support/section.h"

namespace kerfbench::validation {

/// A finished study.
struct Chapter {
  Section section;
  /// True if the chapter stands under its own heading at the end: it differs from run to run.
  bool clock{false};
};

/// Writes the page and, in the folder `validation` next to it, its pictures. Pictures there that the page no
/// longer shows are deleted. `made_with` is the line that says what the figures were made with
/// (tests/figures); a draft has none.
void writePage(const std::filesystem::path& page, const std::vector<Chapter>& chapters,
               const std::string& made_with);

/// The claims of a section as lines of text for a terminal.
std::string claimLines(const Section& section);

}  // namespace kerfbench::validation
