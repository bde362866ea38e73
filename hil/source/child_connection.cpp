// SPDX-License-Identifier: Apache-2.0
#include "hil/source/child_connection.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "hil/source/child_process.h"

namespace kerfbench::source {
namespace {

constexpr std::string_view kTcp = "tcp:";

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};

/// Connects within the time, or returns an invalid descriptor with errno.
base::UniqueFd connected(const addrinfo& address, ChildChannel::Clock::time_point deadline) {
  base::UniqueFd fd(
      ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol));
  if (!fd.valid() || ::connect(fd.get(), address.ai_addr, address.ai_addrlen) == 0) return fd;
  if (errno != EINPROGRESS) return {};
  pollfd polled{fd.get(), POLLOUT, 0};
  int ready = 0;
  do {
    ready = ::poll(&polled, 1, millisecondsTo(deadline));
  } while (ready < 0 && errno == EINTR);
  int error = ETIMEDOUT;
  socklen_t size = sizeof error;
  if (ready > 0) (void)::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error == 0) return fd;
  errno = error;
  return {};
}

}  // namespace

ChildConnection::ChildConnection(const std::string& host, const std::string& port,
                                 std::chrono::milliseconds patience) {
  const std::string name = host + ":" + port;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0)
    throw std::runtime_error(name + ": " + ::gai_strerror(error));
  const std::unique_ptr<addrinfo, FreeAddresses> addresses(found);
  const auto deadline = Clock::now() + patience;
  base::UniqueFd fd;
  for (const addrinfo* address = found; address != nullptr && !fd.valid(); address = address->ai_next)
    fd = connected(*address, deadline);
  if (!fd.valid()) throwErrno(errno, name);
  // Each quantum waits for its answer.
  const int yes = 1;
  (void)::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  base::UniqueFd replies(::fcntl(fd.get(), F_DUPFD_CLOEXEC, 3));
  if (!replies.valid()) throwErrno(errno, name);
  carry(std::move(fd), std::move(replies), {});
}

std::string ChildConnection::finish(std::chrono::milliseconds /*patience*/) {
  closeRequests();
  closeReplies();
  return "closed the connection";
}

void ChildConnection::kill() {
  closeRequests();
  closeReplies();
}

bool isConnection(const std::filesystem::path& child) { return child.string().starts_with(kTcp); }

std::unique_ptr<ChildChannel> openChannel(const std::filesystem::path& child,
                                          std::vector<std::string> launcher) {
  constexpr std::chrono::seconds kPatience{10};
  if (!isConnection(child)) {
    launcher.push_back(child.string());
    return std::make_unique<ChildProcess>(std::move(launcher));
  }
  const std::string address = child.string().substr(kTcp.size());
  const auto colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size())
    throw std::runtime_error(child.string() + ": is no address like tcp:HOST:PORT");
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return std::make_unique<ChildConnection>(host, address.substr(colon + 1), kPatience);
}

}  // namespace kerfbench::source
