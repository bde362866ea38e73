// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/connection.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace kerfbench::serve {
namespace {

/// False: nothing of these events within the time.
bool waitFor(int fd, short events, double wait_s) {
  pollfd poller{fd, events, 0};
  int ready = 0;
  do ready = ::poll(&poller, 1, static_cast<int>(std::ceil(1e3 * wait_s)));
  while (ready < 0 && errno == EINTR);
  return ready > 0;
}

}  // namespace

Connection::Connection(base::UniqueFd socket) : socket_(std::move(socket)) {}

bool Connection::receive(std::size_t most) {
  std::array<char, 16 * 1024> block{};
  while (pending_.size() < most) {
    const std::size_t room = std::min(block.size(), most - pending_.size());
    const ssize_t got = ::recv(fd(), block.data(), room, MSG_DONTWAIT);
    if (got > 0)
      pending_.append(block.data(), static_cast<std::size_t>(got));
    else if (got == 0 || (errno != EAGAIN && errno != EINTR))
      return false;
    else if (errno == EAGAIN)
      return true;
  }
  return true;
}

std::ptrdiff_t Connection::read(char* to, std::size_t size, double wait_s) {
  if (!pending_.empty()) {
    const std::size_t taken = std::min(size, pending_.size());
    std::memcpy(to, pending_.data(), taken);
    drop(taken);
    return static_cast<std::ptrdiff_t>(taken);
  }
  while (true) {
    const ssize_t got = ::recv(fd(), to, size, MSG_DONTWAIT);
    if (got >= 0) return got;
    if (errno == EINTR) continue;
    if (errno != EAGAIN || !waitFor(fd(), POLLIN, wait_s)) return -1;
  }
}

bool Connection::write(std::string_view bytes, double wait_s) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    else if (errno != EINTR && (errno != EAGAIN || !waitFor(fd(), POLLOUT, wait_s)))
      return false;
  }
  return true;
}

void Connection::writeAtOnce(std::string_view bytes) {
  (void)!::send(fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

bool Connection::isGone() const {
  pollfd poller{fd(), POLLRDHUP, 0};
  return ::poll(&poller, 1, 0) > 0;
}

void Connection::endWriting() { (void)::shutdown(fd(), SHUT_WR); }

void Connection::cut() const { (void)::shutdown(fd(), SHUT_RDWR); }

}  // namespace kerfbench::serve
