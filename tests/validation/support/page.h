// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
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
/// longer shows are deleted.
void writePage(const std::filesystem::path& page, const std::vector<Chapter>& chapters);

/// The claims of a section as lines of text for a terminal.
std::string claimLines(const Section& section);

}  // namespace kerfbench::validation
