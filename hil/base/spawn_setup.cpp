// SPDX-License-Identifier: Apache-2.0
#include "hil/base/spawn_setup.h"

#include <signal.h>
#include <unistd.h>

namespace kerfbench::base {

SpawnSetup::SpawnSetup() {
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
}

SpawnSetup::~SpawnSetup() {
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
}

void SpawnSetup::setSignals(bool leads_group) {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::posix_spawnattr_setsigmask(&attributes, &signals);
  ::sigaddset(&signals, SIGPIPE);
  ::posix_spawnattr_setsigdefault(&attributes, &signals);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  constexpr short kSignals = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
  ::posix_spawnattr_setflags(&attributes,
                             leads_group ? static_cast<short>(kSignals | POSIX_SPAWN_SETPGROUP) : kSignals);
}

std::vector<std::string> endingWithParent(std::vector<std::string> command) {
  constexpr const char* kSetpriv = "/usr/bin/setpriv";
  // posix_spawn() itself tells of a program that is not there.
  if (::access(kSetpriv, X_OK) == 0 && ::access(command.front().c_str(), X_OK) == 0)
    command.insert(command.begin(), {kSetpriv, "--pdeathsig", "KILL", "--"});
  return command;
}

std::vector<char*> pointersTo(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace kerfbench::base
