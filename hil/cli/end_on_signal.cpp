// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/end_on_signal.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "hil/base/temporary.h"

namespace kerfbench::cli {
namespace {

bool isIgnored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t endingSignals() {
  sigset_t ending;
  ::sigemptyset(&ending);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (!isIgnored(signal)) ::sigaddset(&ending, signal);
  }
  return ending;
}

/// Ends the process by the signal, whose default that is, once nothing of it is left. The next one does so at
/// once.
[[noreturn]] void end(int signal) {
  const sigset_t ending = endingSignals();
  ::pthread_sigmask(SIG_UNBLOCK, &ending, nullptr);
  base::removeTemporaries();
  (void)::raise(signal);
  ::_exit(128 + signal);
}

base::UniqueFd orThrow(int fd, const char* what) {
  base::UniqueFd owned(fd);
  if (!owned.valid()) throw std::system_error(errno, std::generic_category(), what);
  return owned;
}

}  // namespace

EndOnSignal::EndOnSignal() {
  const sigset_t ending = endingSignals();
  signals_ = orThrow(::signalfd(-1, &ending, SFD_CLOEXEC | SFD_NONBLOCK), "signalfd");
  over_ = orThrow(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd");
  ::pthread_sigmask(SIG_BLOCK, &ending, &before_);
  (void)::signal(SIGPIPE, SIG_IGN);
  thread_ = std::thread([this] { wait(); });
}

EndOnSignal::~EndOnSignal() {
  const std::uint64_t one = 1;
  (void)!::write(over_.get(), &one, sizeof one);
  thread_.join();
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);  // One that has come meanwhile ends the process here.
}

void EndOnSignal::wait() const {
  for (;;) {
    pollfd polled[2] = {{signals_.get(), POLLIN, 0}, {over_.get(), POLLIN, 0}};
    if (::poll(polled, 2, -1) < 0 && errno != EINTR) return;
    signalfd_siginfo info{};
    if (::read(signals_.get(), &info, sizeof info) == static_cast<ssize_t>(sizeof info))
      end(static_cast<int>(info.ssi_signo));
    if (polled[1].revents != 0) return;
  }
}

}  // namespace kerfbench::cli
