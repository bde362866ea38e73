// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/input_file.h"

namespace kerfbench::planner {

/// Name by which standard input is asked for; what comes there is G-code.
inline constexpr const char* kStandardInput = "-";

/// More text than this no program of a unit takes.
inline constexpr std::uint64_t kLargestInput_bytes = std::uint64_t{64} << 20U;

/// Content of a file that a user named, or of standard input. @throws PlanError with the path.
inline std::string inputText(const std::string& path) {
  const bool is_piped = path == kStandardInput;
  base::InputContent text =
      is_piped ? base::readStandardInput(kLargestInput_bytes) : base::readInput(path, kLargestInput_bytes);
  if (!text.bytes) throw PlanError((is_piped ? "standard input" : path) + ": " + text.refusal);
  return *std::move(text.bytes);
}

}  // namespace kerfbench::planner
