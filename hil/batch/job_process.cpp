// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/job_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace kerfbench::batch {
namespace {

[[noreturn]] void throwFor(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// Above the standard descriptors, so that the child's set-up never overwrites one with another.
base::UniqueFd above(int fd, const std::string& what) {
  const base::UniqueFd original(fd);
  if (!original.valid()) throwFor(what);
  base::UniqueFd moved(::fcntl(fd, F_DUPFD_CLOEXEC, 3));
  if (!moved.valid()) throwFor(what);
  return moved;
}

/// What the child does between fork and exec: calls that are safe there, and nothing else.
struct ChildStart {
  std::vector<char*> arguments;
  const char* folder;
  int input, log, failure;
  pid_t parent;

  [[noreturn]] void run() const {
    (void)::setpgid(0, 0);
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);  // The parent has ended before the line above.
    sigset_t none;
    ::sigemptyset(&none);
    (void)::sigprocmask(SIG_SETMASK, &none, nullptr);
    if (::dup2(input, STDIN_FILENO) >= 0 && ::dup2(log, STDOUT_FILENO) >= 0 &&
        ::dup2(log, STDERR_FILENO) >= 0 && (*folder == '\0' || ::chdir(folder) == 0))
      ::execv(arguments.front(), arguments.data());
    const int error = errno;
    (void)!::write(failure, &error, sizeof error);
    ::_exit(127);
  }
};

/// The errno that the child wrote, 0 at the end of the stream: exec has closed it.
int failureIn(int fd) {
  int error = 0;
  ssize_t got = 0;
  do got = ::read(fd, &error, sizeof error);
  while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(sizeof error) ? error : 0;
}

/// The header of glibc 2.36 declares pidfd_open() for C alone.
int openPidFd(pid_t pid) { return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)); }

int statusOf(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

JobProcess::JobProcess(const std::vector<std::string>& command, const std::filesystem::path& log,
                       const std::filesystem::path& folder) {
  if (command.empty()) throw std::system_error(EINVAL, std::generic_category(), "a job without a command");
  const std::string& name = command.front();
  const base::UniqueFd output = above(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644),
                                      "cannot write " + log.string());
  const base::UniqueFd input = above(::open("/dev/null", O_RDONLY | O_CLOEXEC), "cannot open /dev/null");
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throwFor("cannot make a pipe");
  const base::UniqueFd reading(ends[0]);
  base::UniqueFd writing = above(ends[1], "cannot make a pipe");
  std::vector<std::string> words = command;
  ChildStart child{{}, folder.c_str(), input.get(), output.get(), writing.get(), ::getpid()};
  for (std::string& word : words) child.arguments.push_back(word.data());
  child.arguments.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throwFor("cannot start " + name);
  if (pid_ == 0) child.run();
  (void)::setpgid(pid_, pid_);  // Here as well: a signal for the group may follow at once.
  writing.reset();
  not_started_ = failureIn(reading.get());
  pidfd_ = base::UniqueFd(openPidFd(pid_));
  if (pidfd_.valid()) return;
  const int error = errno;
  signal(SIGKILL);
  (void)statusOf(std::exchange(pid_, -1));
  throw std::system_error(error, std::generic_category(), "cannot wait for " + name);
}

JobProcess::JobProcess(JobProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      pidfd_(std::move(other.pidfd_)),
      stopwatch_(std::move(other.stopwatch_)),
      not_started_(other.not_started_) {}

JobProcess::~JobProcess() {
  if (pid_ <= 0) return;
  signal(SIGKILL);
  (void)statusOf(pid_);
}

void JobProcess::signal(int number) const {
  if (pid_ > 0) (void)::kill(-pid_, number);
}

JobEnd JobProcess::finish() {
  // The group is killed while the process is still a zombie: its number belongs to nobody else until then.
  siginfo_t info{};
  while (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  signal(SIGKILL);
  const int status = statusOf(std::exchange(pid_, -1));
  const double wall_s = stopwatch_.total_s();
  if (not_started_ != 0) return {JobEnd::How::kNotStarted, not_started_, wall_s};
  if (WIFSIGNALED(status)) return {JobEnd::How::kSignal, WTERMSIG(status), wall_s};
  return {JobEnd::How::kExited, WEXITSTATUS(status), wall_s};
}

}  // namespace kerfbench::batch
