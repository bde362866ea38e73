// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spawn.h>

#include <string>
#include <vector>

namespace kerfbench::base {

/// Actions and attributes of posix_spawn in the child, freed at the end of the scope.
struct SpawnSetup {
  SpawnSetup();
  ~SpawnSetup();
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;

  /// The child starts with no signal blocked and SIGPIPE not ignored, whatever thread of this process starts
  /// it, and leads a process group of its own if `leads_group`.
  void setSignals(bool leads_group);

  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
};

/// The command, run so that the kernel kills it when the thread that starts it ends, by setpriv of
/// util-linux; as it is where that, or the program, is not there. The program by its path.
std::vector<std::string> endingWithParent(std::vector<std::string> command);

/// For the calls of the system; valid as long as `words` are.
std::vector<char*> pointersTo(std::vector<std::string>& words);

}  // namespace kerfbench::base
