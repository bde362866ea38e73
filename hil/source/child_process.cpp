// SPDX-License-Identifier: Apache-2.0
#include "hil/source/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "hil/base/spawn_setup.h"

extern char** environ;

namespace kerfbench::source {
namespace {

/// Above the standard descriptors, so that the child's set-up never overwrites one with another.
base::UniqueFd aboveStandard(int fd, const std::string& what) {
  const base::UniqueFd original(fd);
  base::UniqueFd moved(::fcntl(fd, F_DUPFD_CLOEXEC, 3));
  if (!moved.valid()) throwErrno(errno, what);
  return moved;
}

std::pair<base::UniqueFd, base::UniqueFd> makePipe(const std::string& what) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throwErrno(errno, what);
  base::UniqueFd second(ends[1]);
  auto read_end = aboveStandard(ends[0], what);
  return {std::move(read_end), aboveStandard(second.release(), what)};
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> command) {
  const std::string& name = command.front();
  auto [child_stdin, our_requests] = makePipe(name);
  auto [our_replies, child_stdout] = makePipe(name);
  auto [our_stderr, child_stderr] = makePipe(name);
  base::SpawnSetup setup;
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stdin.get(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stdout.get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stderr.get(), STDERR_FILENO);
  // What the child starts ends with it.
  setup.setSignals(true);
  const std::vector<char*> arguments = base::pointersTo(command);
  const int error =
      ::posix_spawn(&pid_, name.c_str(), &setup.actions, &setup.attributes, arguments.data(), environ);
  if (error != 0) {
    pid_ = -1;
    throwErrno(error, name);
  }
  carry(std::move(our_requests), std::move(our_replies), std::move(our_stderr));
}

ChildProcess::~ChildProcess() {
  kill();
  try {
    (void)finish(std::chrono::milliseconds(0));
  } catch (...) {
    // Out of memory for the tail of its stderr, which nobody will read.
  }
}

void ChildProcess::kill() {
  if (pid_ > 0) ::kill(-pid_, SIGKILL);
}

// The child is not reaped, so that its number still stands for its group.
bool ChildProcess::hasEnded() const {
  siginfo_t info{};
  const int failed = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  return failed == 0 ? info.si_pid == pid_ : errno != EINTR;
}

std::string ChildProcess::finish(std::chrono::milliseconds patience) {
  closeRequests();
  const auto deadline = Clock::now() + patience;
  while (pid_ > 0) {
    if (hasEnded() || Clock::now() >= deadline) {
      kill();  // Reaches what the child has left behind as well.
      while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
      }
      pid_ = -1;
    } else {
      waitForStderr(deadline);
    }
  }
  drainStderr();
  if (WIFSIGNALED(status_)) return std::string("was ended by signal ") + ::strsignal(WTERMSIG(status_));
  return "ended with exit status " + std::to_string(WEXITSTATUS(status_));
}

}  // namespace kerfbench::source
