// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/compare/comparison.h"

namespace kerfbench::compare {

/// Both releases and how they differ.
struct ComparedReleases {
  RunSet old_release, new_release;
  Comparison comparison;
};

/// For a terminal: cautions, verdicts that changed, the figures that differ significantly (the first of each
/// quantity, and how many more), and one line that sums up.
std::vector<std::string> comparisonLines(const ComparedReleases& compared);

/// One sentence: "2 figures are worse, 1 is better, 410 are the same within their U."
std::string comparisonSummary(const Comparison& comparison);

/// compare.json: all figures.
std::string comparisonJson(const ComparedReleases& compared);

/// compare.html: one self-contained page; differs first, all figures below.
std::string comparisonPage(const ComparedReleases& compared);

/// Writes compare.html and compare.json into the folder, which is made, each whole or not at all.
/// @throws std::system_error with the path.
void writeComparison(const ComparedReleases& compared, const std::filesystem::path& folder);

}  // namespace kerfbench::compare
