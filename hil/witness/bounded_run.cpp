// SPDX-License-Identifier: Apache-2.0
#include "hil/witness/bounded_run.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "hil/base/spawn_setup.h"
#include "hil/base/text.h"
#include "hil/base/unique_fd.h"

namespace kerfbench::witness {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void throwOf(int error, const char* what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// A pipe of which neither end has the number of a standard stream.
struct OutputPipe {
  base::UniqueFd ours;
  base::UniqueFd childs;
  OutputPipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throwOf(errno, "pipe");
    const base::UniqueFd reading(ends[0]);
    const base::UniqueFd writing(ends[1]);
    ours = base::UniqueFd(::fcntl(reading.get(), F_DUPFD_CLOEXEC, 3));
    childs = base::UniqueFd(::fcntl(writing.get(), F_DUPFD_CLOEXEC, 3));
    if (!ours.valid() || !childs.valid()) throwOf(errno, "pipe");
    ::fcntl(ours.get(), F_SETFL, O_NONBLOCK);
  }
};

/// A child with its children, which are gone at the end of the scope.
class ChildGroup {
 public:
  ChildGroup(const std::vector<std::string>& command, int output, int errors) {
    base::SpawnSetup setup;
    ::posix_spawn_file_actions_addopen(&setup.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&setup.actions, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&setup.actions, errors, STDERR_FILENO);
    setup.setSignals(true);
    std::vector<std::string> words = command;
    const std::vector<char*> arguments = base::pointersTo(words);
    // Nothing of the user's settings: the answer depends on the drawing alone.
    std::array<std::string, 3> values{"PATH=/usr/bin:/bin", "LC_ALL=C.UTF-8", "HOME=/nonexistent"};
    std::array<char*, 4> environment{values[0].data(), values[1].data(), values[2].data(), nullptr};
    error_ = ::posix_spawn(&pid_, arguments.front(), &setup.actions, &setup.attributes, arguments.data(),
                           environment.data());
    if (error_ != 0) pid_ = -1;
  }
  ~ChildGroup() {
    if (pid_ > 0) (void)end();
  }
  ChildGroup(const ChildGroup&) = delete;
  ChildGroup& operator=(const ChildGroup&) = delete;

  [[nodiscard]] int error() const { return error_; }

  /// Sets the limits, for its children as well. What it did before they are set counts.
  void limit(const RunLimits& limits) const {
    const auto set = [&](auto what, rlim_t soft, rlim_t hard) {
      const rlimit limit{soft, hard};
      (void)::prlimit(pid_, what, &limit, nullptr);
    };
    const auto cpu_s = static_cast<rlim_t>(limits.cpu_s);
    set(RLIMIT_CPU, cpu_s, cpu_s + 1);
    set(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
    set(RLIMIT_CORE, 0, 0);
  }

  /// Waits for the child and returns its status, or nothing at the deadline.
  std::optional<int> waitUntil(Clock::time_point deadline) {
    int status = 0;
    for (;;) {
      const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
      if (ended == pid_ || (ended < 0 && errno != EINTR)) break;
      if (Clock::now() >= deadline) return std::nullopt;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ::kill(-pid_, SIGKILL);  // Children that it left.
    pid_ = -1;
    return status;
  }

  /// Stops it now.
  int end() {
    int status = 0;
    ::kill(-pid_, SIGKILL);
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_{-1};
  int error_{};
};

/// Appends what is there. False at the end of the stream.
bool drain(int fd, std::string& text) {
  std::array<char, 16384> buffer{};
  const ssize_t count = ::read(fd, buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

/// Reads both streams to their ends. Returns why it gave up, or nothing.
std::string readAll(OutputPipe& output, OutputPipe& errors, const RunLimits& limits,
                    Clock::time_point deadline, std::string& printed, std::string& complaint) {
  constexpr std::size_t kMostComplaint = 64U << 10U;
  std::array<pollfd, 2> open{{{output.ours.get(), POLLIN, 0}, {errors.ours.get(), POLLIN, 0}}};
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return fmt::format("did not end within {:g} s and was stopped", limits.deadline_s);
    const int ready = ::poll(open.data(), open.size(), static_cast<int>(std::min<long long>(left, 1000)));
    if (ready < 0 && errno != EINTR) throwOf(errno, "poll");
    if (ready <= 0) continue;
    if (open[0].revents != 0 && !drain(open[0].fd, printed)) open[0].fd = -1;
    if (open[1].revents != 0 && !drain(open[1].fd, complaint)) open[1].fd = -1;
    if (printed.size() > limits.output_bytes || complaint.size() > kMostComplaint)
      return fmt::format("printed more than {} bytes and was stopped",
                         printed.size() > limits.output_bytes ? limits.output_bytes : kMostComplaint);
  }
  return {};
}

/// The last line that says something, as that of a Python exception does.
std::string lastWords(std::string_view complaint) {
  complaint = base::trimmed(complaint);
  const std::size_t end_of_line = complaint.rfind('\n');
  if (end_of_line != std::string_view::npos) complaint.remove_prefix(end_of_line + 1);
  return complaint.empty() ? "" : ": " + base::printable(complaint, 200);
}

std::string howItEnded(int status, const RunLimits& limits, std::string_view complaint) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return fmt::format("took more than {} s of processor and was stopped", limits.cpu_s);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return fmt::format("was killed, after {} s of processor or for want of memory", limits.cpu_s);
  if (WIFSIGNALED(status)) return fmt::format("was ended by the signal {}", ::strsignal(WTERMSIG(status)));
  if (complaint.find("MemoryError") != std::string_view::npos)
    return fmt::format("wanted more than {} MiB of memory", limits.memory_bytes >> 20U);
  return fmt::format("ended with exit status {}{}", WEXITSTATUS(status), lastWords(complaint));
}

}  // namespace

BoundedOutput runBounded(const std::vector<std::string>& command, const RunLimits& limits) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.deadline_s));
  OutputPipe output;
  OutputPipe errors;
  ChildGroup child(command, output.childs.get(), errors.childs.get());
  BoundedOutput result;
  if (child.error() != 0) {
    result.could_start = false;
    result.trouble = fmt::format("cannot be started: {}", ::strerror(child.error()));
    return result;
  }
  child.limit(limits);
  output.childs.reset();
  errors.childs.reset();
  std::string complaint;
  result.trouble = readAll(output, errors, limits, deadline, result.output, complaint);
  if (!result.trouble.empty()) {
    (void)child.end();
    return result;
  }
  const std::optional<int> status = child.waitUntil(deadline);
  result.trouble = status ? howItEnded(*status, limits, complaint)
                          : fmt::format("did not end within {:g} s and was stopped", limits.deadline_s);
  return result;
}

}  // namespace kerfbench::witness
