// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hil/batch/job.h"

namespace kerfbench::batch {

/// File in a job's folder that is written last, and whole or not at all: how the job ended, on which inputs,
/// and the size and SHA-256 of everything else in the folder. A folder without it is no result.
inline constexpr const char* kJobRecord = "job.json";
/// What the command wrote to its standard output and standard error.
inline constexpr const char* kJobLog = "log.txt";

/// What the folder of a job holds.
struct JobFolder {
  enum class State {
    kAbsent,       ///< Nothing is there, or an empty folder.
    kUnfinished,   ///< The job was begun here, and neither ended nor was recorded.
    kWhole,        ///< The result of these inputs, as it was recorded; `end` is set.
    kOtherInputs,  ///< A result, but one of other inputs.
    kDamaged,      ///< Files were changed, are missing or were added since; or the record is broken.
    kForeign,      ///< No job wrote it, or a bench whose records this one does not read.
  };
  State state{State::kAbsent};
  std::string why{};            ///< A sentence that names the folder; empty for kAbsent and kWhole.
  std::optional<JobEnd> end{};  ///< How the job ended, of kWhole.
};

/// Looks at the folder and reads all of it.
/// @throws std::system_error if the system cannot read what is there.
JobFolder lookAt(const Job& job);

/// Records how the job ended; its folder is whole then. @throws std::system_error: it is not.
void recordEnd(const Job& job, const JobEnd& end);

/// Gives a folder the first free of the names NAME.1, NAME.2 …, which it returns.
/// @throws std::system_error.
std::filesystem::path setAside(const std::filesystem::path& folder);
/// The number of folders that setAside() made of this one.
int asideOf(const std::filesystem::path& folder);

}  // namespace kerfbench::batch
