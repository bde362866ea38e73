// SPDX-License-Identifier: Apache-2.0
#include "hil/source/child_channel.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <system_error>
#include <thread>
#include <utility>

namespace kerfbench::source {
namespace {

constexpr std::size_t kKeptStderrBytes = 2000;

void setNonBlocking(const base::UniqueFd& fd) {
  (void)::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) | O_NONBLOCK);
}

/// A write to a pipe that nobody reads any more raises SIGPIPE, which would end the process; here it is only
/// an answer (EPIPE). The signals of the process stay as they are. A socket has a flag for this, and takes
/// twice as long.
ssize_t writeQuietly(int fd, std::span<const std::uint8_t> bytes) {
  sigset_t broken_pipe;
  sigset_t before;
  ::sigemptyset(&broken_pipe);
  ::sigaddset(&broken_pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &broken_pipe, &before);
  const ssize_t put = ::write(fd, bytes.data(), bytes.size());
  const int error = errno;
  if (put < 0 && error == EPIPE && ::sigismember(&before, SIGPIPE) == 0) {
    constexpr timespec kNow{};
    while (::sigtimedwait(&broken_pipe, nullptr, &kNow) < 0 && errno == EINTR) {
    }
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return put;
}

}  // namespace

int millisecondsTo(ChildChannel::Clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - ChildChannel::Clock::now()).count();
  return static_cast<int>(std::clamp<long long>(left, 0, 3'600'000));
}

void throwErrno(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

void ChildChannel::carry(base::UniqueFd requests, base::UniqueFd replies, base::UniqueFd stderr_of_child) {
  requests_ = std::move(requests);
  replies_ = std::move(replies);
  setNonBlocking(requests_);
  stderr_ = std::move(stderr_of_child);
  setNonBlocking(replies_);
  if (stderr_.valid()) setNonBlocking(stderr_);
}

bool ChildChannel::drainStderr() {
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
bool ChildChannel::waitFor(short events, int fd, Clock::time_point deadline) {
  for (;;) {
    pollfd polled[2] = {{fd, events, 0}, {stderr_.get(), POLLIN, 0}};
    const int ready = ::poll(polled, stderr_.valid() ? 2 : 1, millisecondsTo(deadline));
    if (ready < 0 && errno != EINTR) throwErrno(errno, "poll");
    if (ready > 0 && stderr_.valid() && polled[1].revents != 0) drainStderr();
    if (ready > 0 && polled[0].revents != 0) return true;
    if (ready <= 0 && Clock::now() >= deadline) return false;
  }
}

void ChildChannel::waitForStderr(Clock::time_point deadline) {
  if (stderr_.valid()) {
    (void)waitFor(POLLHUP, stderr_.get(), std::min(deadline, Clock::now() + std::chrono::milliseconds(5)));
  } else {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

ChildChannel::Io ChildChannel::write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t put = writeQuietly(requests_.get(), bytes);
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

ChildChannel::Io ChildChannel::fetch(Clock::time_point deadline) {
  // The child has just been asked: it will hardly have answered yet.
  if (!waitFor(POLLIN, replies_.get(), deadline)) return Io::kTimedOut;
  const ssize_t got = ::read(replies_.get(), buffer_.data(), buffer_.size());
  const bool again = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  fetched_ = std::span(buffer_).first(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return got > 0 || again ? Io::kDone : Io::kClosed;
}

ChildChannel::Io ChildChannel::read(std::span<std::uint8_t> into, Clock::time_point deadline) {
  for (;;) {
    const std::size_t taken = std::min(into.size(), fetched_.size());
    std::copy_n(fetched_.begin(), taken, into.begin());
    fetched_ = fetched_.subspan(taken);
    into = into.subspan(taken);
    if (into.empty()) return Io::kDone;
    if (const Io io = fetch(deadline); io != Io::kDone) return io;
  }
}

std::string ChildChannel::lastWords() {
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
