// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/file_content.h"

namespace kerfbench::planner {

/// Name by which standard input is asked for; what comes there is G-code.
inline constexpr const char* kStandardInput = "-";

/// All that comes on standard input. @throws PlanError beyond 64 MiB, which no program of a unit takes.
inline std::string standardInputText() {
  constexpr std::size_t kMost = std::size_t{64} << 20U;
  std::string text;
  std::array<char, 65536> piece{};
  while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), stdin)) {
    text.append(piece.data(), got);
    if (text.size() > kMost) throw PlanError("standard input: more than 64 MiB");
  }
  return text;
}

/// Content of a file that a user named, or of standard input. @throws PlanError with the path.
inline std::string inputText(const std::string& path) {
  if (path == kStandardInput) return standardInputText();
  std::optional<std::string> text = base::fileContent(path);
  if (!text) throw PlanError(path + ": cannot be opened");
  return *std::move(text);
}

}  // namespace kerfbench::planner
