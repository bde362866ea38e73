// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <semaphore>
#include <string>

#include "hil/serve/answer.h"
#include "hil/serve/work_folder.h"

namespace kerfbench::serve {

/// What the job page asks of hil/desk: from names of files to paths, and from faults of the user's files to
/// answers. May be used by several threads.
class DeskRoutes {
 public:
  /// Requests at a time: each may keep a processor busy for seconds, and a run has to have one.
  static constexpr int kAtOnce = 2;

  DeskRoutes(const WorkFolder& files, std::filesystem::path bin_dir)
      : files_(files), bin_dir_(std::move(bin_dir)) {}

  /// GET /api/reference?page=scenario
  Answer reference(const Asked& asked);
  /// POST /api/check {"scenario_text", "path"}
  Answer check(const Asked& asked);
  /// POST /api/edit, the body as hil/desk has it.
  Answer edit(const Asked& asked);

 private:
  /// JSON by the desk; what it refuses is told with status 400.
  Answer byDesk(const std::function<std::string()>& work);

  const WorkFolder& files_;
  std::filesystem::path bin_dir_;
  std::counting_semaphore<kAtOnce> places_{kAtOnce};
};

}  // namespace kerfbench::serve
