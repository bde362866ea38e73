// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/file_content.h"

namespace kerfbench::planner {

/// Content of a file that a user named. @throws PlanError with the path.
inline std::string inputText(const std::string& path) {
  std::optional<std::string> text = base::fileContent(path);
  if (!text) throw PlanError(path + ": cannot be opened");
  return *std::move(text);
}

}  // namespace kerfbench::planner
