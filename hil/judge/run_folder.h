// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "hil/judge/results_folder.h"

namespace kerfbench::judge {

/// Link in the folder of a scenario to the results of its latest run.
inline constexpr const char* kLatestRun = "latest";

/// "20261128T160512Z-1a2b3c4d": when a run ended, in UTC, and the first digits of its digest. Names in the
/// order of the alphabet are in the order of time.
std::string runFolderName(std::chrono::system_clock::time_point ended, const std::string& digest);
/// Whether a folder may have been named by runFolderName(), and "-2" and so on where that was taken.
bool isRunFolderName(const std::string& name);

/// Refuses before anything runs what would keep commit() of a RunFolder from its place: a file where the
/// folder of the scenario should be, or something else than a link by the name of kLatestRun in it; or
/// anything in the place of `output`.
/// @throws base::InputError.
void refuseBlockedRuns(const std::filesystem::path& results_dir, const std::string& name,
                       const std::filesystem::path& output = {});

/// Makes the link `latest` beside a folder lead to it; one that is there is exchanged in one step.
/// @throws std::system_error.
void linkLatest(const std::filesystem::path& folder);

/// The results of one run among those of the same scenario: results_dir/NAME/DATE-DIGEST, which appears whole
/// or not at all, and NAME/latest, a link to it. Nothing of earlier runs is replaced. Results that an older
/// bench left in NAME itself move into a folder beside the new one. With an `output` the results are that
/// folder, and no link is made.
class RunFolder {
 public:
  /// @throws std::system_error if `results_dir`, or the folder that `output` is to be in, cannot be made or
  /// written.
  RunFolder(const std::filesystem::path& results_dir, const std::string& name,
            const std::filesystem::path& output = {});

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& staging() const { return folder_->staging(); }
  /// Puts the folder in its place and the link to it. @throws std::system_error; nothing has changed then but
  /// what was made of an older bench's results.
  void commit(std::chrono::system_clock::time_point ended, const std::string& digest);
  /// Where the results are after commit().
  [[nodiscard]] const std::filesystem::path& place() const { return place_; }

 private:
  std::filesystem::path name_folder_;
  std::filesystem::path output_;  ///< Absolute; empty: the place is one in name_folder_.
  std::filesystem::path place_;
  std::optional<ResultsFolder> folder_;
};

}  // namespace kerfbench::judge
