// SPDX-License-Identifier: Apache-2.0
#include "hil/source/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include "hil/base/spawn_setup.h"

extern char** environ;

namespace kerfbench::source {
namespace {

constexpr std::size_t kKeptStderrBytes = 2000;

[[noreturn]] void throwErrno(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

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

/// A socket and not a pipe: send() takes a flag against SIGPIPE, which leaves the process' signals alone.
std::pair<base::UniqueFd, base::UniqueFd> makeSocketPair(const std::string& what) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throwErrno(errno, what);
  base::UniqueFd second(ends[1]);
  auto ours = aboveStandard(ends[0], what);
  return {std::move(ours), aboveStandard(second.release(), what)};
}

void setNonBlocking(const base::UniqueFd& fd) {
  (void)::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) | O_NONBLOCK);
}

int millisecondsTo(ChildProcess::Clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - ChildProcess::Clock::now()).count();
  return static_cast<int>(std::clamp<long long>(left, 0, 3'600'000));
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program) {
  const std::string name = program.string();
  auto [our_requests, child_stdin] = makeSocketPair(name);
  auto [our_replies, child_stdout] = makePipe(name);
  auto [our_stderr, child_stderr] = makePipe(name);
  base::SpawnSetup setup;
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stdin.get(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stdout.get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&setup.actions, child_stderr.get(), STDERR_FILENO);
  // The child starts with no signal blocked, whatever thread of the bench starts it.
  sigset_t none;
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&setup.attributes, &none);
  ::posix_spawnattr_setflags(&setup.attributes, POSIX_SPAWN_SETSIGMASK);
  std::string argument = name;
  char* const arguments[] = {argument.data(), nullptr};
  const int error = ::posix_spawn(&pid_, name.c_str(), &setup.actions, &setup.attributes, arguments, environ);
  if (error != 0) {
    pid_ = -1;
    throwErrno(error, name);
  }
  requests_ = std::move(our_requests);
  replies_ = std::move(our_replies);
  stderr_ = std::move(our_stderr);
  setNonBlocking(replies_);
  setNonBlocking(stderr_);
}

ChildProcess::~ChildProcess() {
  kill();
  try {
    (void)finish(std::chrono::milliseconds(0));
  } catch (...) {
    // Out of memory for the tail of its stderr, which nobody will read.
  }
}

bool ChildProcess::drainStderr() {
  char block[4096];
  while (stderr_.valid()) {
    const ssize_t got = ::read(stderr_.get(), block, sizeof block);
    if (got > 0) {
      stderr_tail_.append(block, static_cast<std::size_t>(got));
      if (stderr_tail_.size() > kKeptStderrBytes) {
        stderr_tail_.erase(0, stderr_tail_.size() - kKeptStderrBytes);
      }
    } else if (got == 0) {
      stderr_.reset();
    } else if (errno != EINTR) {
      break;
    }
  }
  return stderr_.valid();
}

/// Waits until `fd` is ready, with the child's stderr kept flowing. False: the deadline has passed.
bool ChildProcess::waitFor(short events, int fd, Clock::time_point deadline) {
  for (;;) {
    pollfd polled[2] = {{fd, events, 0}, {stderr_.get(), POLLIN, 0}};
    const int ready = ::poll(polled, stderr_.valid() ? 2 : 1, millisecondsTo(deadline));
    if (ready < 0 && errno != EINTR) throwErrno(errno, "poll");
    if (ready > 0 && stderr_.valid() && polled[1].revents != 0) drainStderr();
    if (ready > 0 && polled[0].revents != 0) return true;
    if (ready <= 0 && Clock::now() >= deadline) return false;
  }
}

ChildProcess::Io ChildProcess::write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t put = ::send(requests_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (put > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(put));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!waitFor(POLLOUT, requests_.get(), deadline)) return Io::kTimedOut;
    } else if (errno != EINTR) {
      return Io::kClosed;
    }
  }
  return Io::kDone;
}

ChildProcess::Io ChildProcess::fetch(Clock::time_point deadline) {
  // The child has just been asked: it will hardly have answered yet.
  if (!waitFor(POLLIN, replies_.get(), deadline)) return Io::kTimedOut;
  const ssize_t got = ::read(replies_.get(), buffer_.data(), buffer_.size());
  const bool again = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  fetched_ = std::span(buffer_).first(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return got > 0 || again ? Io::kDone : Io::kClosed;
}

ChildProcess::Io ChildProcess::read(std::span<std::uint8_t> into, Clock::time_point deadline) {
  for (;;) {
    const std::size_t taken = std::min(into.size(), fetched_.size());
    std::copy_n(fetched_.begin(), taken, into.begin());
    fetched_ = fetched_.subspan(taken);
    into = into.subspan(taken);
    if (into.empty()) return Io::kDone;
    if (const Io io = fetch(deadline); io != Io::kDone) return io;
  }
}

void ChildProcess::kill() {
  if (pid_ > 0) ::kill(pid_, SIGKILL);
}

std::string ChildProcess::finish(std::chrono::milliseconds patience) {
  requests_.reset();
  const auto deadline = Clock::now() + patience;
  while (pid_ > 0) {
    const pid_t reaped = ::waitpid(pid_, &status_, WNOHANG);
    if (reaped == pid_ || (reaped < 0 && errno != EINTR)) {
      pid_ = -1;
    } else if (Clock::now() >= deadline) {
      kill();
      while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
      }
      pid_ = -1;
    } else {
      // Wait for the child's end of the pipe, which closes when the child ends.
      if (stderr_.valid()) {
        (void)waitFor(POLLHUP, stderr_.get(),
                      std::min(deadline, Clock::now() + std::chrono::milliseconds(5)));
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  }
  drainStderr();
  if (WIFSIGNALED(status_)) return std::string("was ended by signal ") + ::strsignal(WTERMSIG(status_));
  return "ended with exit status " + std::to_string(WEXITSTATUS(status_));
}

std::string ChildProcess::lastWords() {
  drainStderr();
  std::string words;
  for (const char c : stderr_tail_) {
    if (c == '\n') {
      words += " | ";
    } else {
      words += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    }
  }
  while (words.ends_with(" | ")) words.resize(words.size() - 3);
  constexpr std::size_t kShown = 400;
  return words.size() > kShown ? "… " + words.substr(words.size() - kShown) : words;
}

}  // namespace kerfbench::source
