// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/stop_signals.h"

#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace kerfbench::batch {

StopSignals::StopSignals() {
  sigset_t stopping;
  ::sigemptyset(&stopping);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    // A blocked signal is never ignored: it would come all the same.
    const bool is_ignored = ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
    if (!is_ignored) ::sigaddset(&stopping, signal);
  }
  const int error = ::pthread_sigmask(SIG_BLOCK, &stopping, &before_);
  if (error != 0) throw std::system_error(error, std::generic_category(), "cannot block signals");
  fd_ = base::UniqueFd(::signalfd(-1, &stopping, SFD_CLOEXEC | SFD_NONBLOCK));
  if (fd_.valid()) return;
  const int why = errno;
  (void)::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  throw std::system_error(why, std::generic_category(), "cannot wait for signals");
}

StopSignals::~StopSignals() { (void)::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

std::optional<int> StopSignals::take() {
  signalfd_siginfo info{};
  if (::read(fd_.get(), &info, sizeof info) != static_cast<ssize_t>(sizeof info)) return std::nullopt;
  return static_cast<int>(info.ssi_signo);
}

}  // namespace kerfbench::batch
