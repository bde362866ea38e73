// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "hil/dieline/faults.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

/// Most entities of a file, those of nested blocks included.
inline constexpr std::size_t kMostEntities = 1'000'000;
/// Most elements of an SVG, those that `use` repeats and those that draw nothing included.
inline constexpr std::size_t kMostElements = 2'000'000;
/// Most attributes of an SVG's elements.
inline constexpr std::size_t kMostAttributes = 10'000'000;
/// Most attributes of one element of an SVG: programs that draw write some dozens.
inline constexpr std::size_t kMostOfElement = 1000;
/// Lines no longer than this are none, mm.
inline constexpr double kNothing_mm = 1e-9;
inline constexpr int kDeepestNesting = 16;  ///< Most levels of INSERT in INSERT, and of use in use.
inline constexpr std::size_t kLargestFile = 256U << 20U;  ///< Most bytes of a file.

/// Tells how much of a file is read, of so many bytes in all.
inline base::ShareProgress readingProgress(const DrawingOptions& options, const FaultList& faults,
                                           std::size_t bytes) {
  return {options.progress, "reading " + std::filesystem::path(faults.path()).filename().string(), bytes};
}

/// Reads the whole text of a file and numbers its entities. @throws DielineError
Dieline readDxf(std::string text, const DrawingOptions& options, FaultList& faults);
Dieline readSvg(std::string text, const DrawingOptions& options, FaultList& faults);
/// These say how long a unit is: an option that says it again is a fault.
Dieline readCf2(const std::string& text, const DrawingOptions& options, FaultList& faults);
Dieline readPdf(const std::string& bytes, const DrawingOptions& options, FaultList& faults);

}  // namespace kerfbench::dieline
