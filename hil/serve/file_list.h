// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hil/serve/work_folder.h"

namespace kerfbench::serve {

/// Bounds of what is looked at, so that a folder of somebody's whole disk takes no minutes.
inline constexpr std::size_t kMostFilesSeen = 20'000;
inline constexpr std::size_t kMostRunsListed = 200;
inline constexpr int kDeepestFolder = 6;

/// What a user can choose from. May be used by several threads.
class FileList {
 public:
  explicit FileList(const WorkFolder& files) : files_(files) {}

  /// GET /api/files:
  ///
  ///     {"scenarios": [{"path", "name", "title", "problem"?}], "machines": [{"path", "name"}],
  ///      "drawings": [{"path"}], "images": [{"path", "title", "firmware": {"source", "image", …}}],
  ///      "service": [{"path"}], "service_files": [{"path", "kind", "id"?, "date"?}],
  ///      "runs": [{"path", "scenario", "verdict", "when", "serial_number"?}], "traces": [{"path", "bytes"}],
  ///      "left_out": n}
  ///
  /// Runs are the newest ones, the newest first. `left_out`: files that were not looked at, beyond the bounds
  /// above or by their names.
  [[nodiscard]] nlohmann::json json() const;

 private:
  [[nodiscard]] nlohmann::json verdictOf(const std::string& run_folder) const;

  const WorkFolder& files_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::string> verdicts_;  ///< Rows of runs, which do not change, by folder.
};

}  // namespace kerfbench::serve
