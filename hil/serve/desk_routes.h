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
  /// POST /api/plan {"scenario_text", "path", "gcode"}
  Answer plan(const Asked& asked);
  /// POST /api/order {"scenario_text", "path", "order": [id …]}
  Answer order(const Asked& asked);
  /// POST /api/new {"drawing", "machine", "name"}: a first scenario for a drawing, or {"from", "text",
  /// "name"}: a copy of a scenario, as its text stands in the editor. Both are written, under a name that is
  /// free.
  Answer create(const Asked& asked);
  /// POST /api/place {"scenario_text", "path", "unit"}
  Answer place(const Asked& asked);
  /// Refuses a drawing of which nothing can be cut; `name`: as its user knows it. Other files pass.
  /// @throws Refusal 400.
  void refuseUncuttable(const std::filesystem::path& file, const std::string& name);

 private:
  /// "jobs/NAME.yaml", with a number where that is there already.
  std::string freeName(const std::string& folder, const std::string& wanted) const;

  /// JSON by the desk; what it refuses is told with status 400.
  Answer byDesk(const std::function<std::string()>& work);

  const WorkFolder& files_;
  std::filesystem::path bin_dir_;
  std::counting_semaphore<kAtOnce> places_{kAtOnce};
};

}  // namespace kerfbench::serve
