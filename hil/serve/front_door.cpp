// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/front_door.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "hil/base/input_error.h"
#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

/// Connections that the kernel keeps until they are accepted.
constexpr int kBacklog = 256;
/// When no descriptor is left, the door waits so long before it asks for one again.
constexpr int kRest_ms = 50;

/// Text of a socket's own address, and its port.
ServerAddress boundAddress(int fd) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&storage), &size) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot listen");
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  ::getnameinfo(reinterpret_cast<sockaddr*>(&storage), size, host.data(), host.size(), port.data(),
                port.size(), NI_NUMERICHOST | NI_NUMERICSERV);
  return {host.data(), std::stoi(port.data())};
}

base::UniqueFd listeningAt(const ServerAddress& wanted) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  if (::getaddrinfo(wanted.address.c_str(), std::to_string(wanted.port).c_str(), &hints, &found) != 0)
    throw base::InputError(fmt::format(
        "--address {}: not an address as a number, like 127.0.0.1 or 192.168.0.7", wanted.address));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, ::freeaddrinfo);
  base::UniqueFd fd(::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  // A server that was ended a moment ago leaves its port waiting; it never lets two listen at once.
  if (fd.valid()) (void)::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (!fd.valid() || ::bind(fd.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(fd.get(), kBacklog) != 0)
    throw base::InputError(fmt::format("cannot listen at {}: {}{}", hostAndPort(wanted), std::strerror(errno),
                                       errno == EADDRINUSE ? "; --port 0 takes one that is free" : ""));
  return fd;
}

}  // namespace

std::string refusalBytes(int status, const std::string& sentence) {
  const std::string body =
      nlohmann::json{{"error", sentence}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
      "\n";
  return fmt::format(
      "HTTP/1.1 {} Refused\r\nContent-Type: application/json\r\nContent-Length: {}\r\nCache-Control: "
      "no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n{}",
      status, body.size(), body);
}

FrontDoor::FrontDoor(const ServerAddress& wanted, const DoorLimits& limits)
    : limits_(limits), listening_(listeningAt(wanted)), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!wake_.valid()) throw std::system_error(errno, std::generic_category(), "eventfd");
  address_ = boundAddress(listening_.get());
}

FrontDoor::~FrontDoor() { endWork(); }

void FrontDoor::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);
}

void FrontDoor::run(Host& host) {
  while (true) {
    pollGuests(host);
    const std::lock_guard lock(mutex_);
    if (stopping_) break;
  }
  endWork();
}

int FrontDoor::waitingTime_ms() const {
  const auto nearest = std::ranges::min_element(guests_, {}, [](const Guest& guest) { return guest.until; });
  if (nearest == guests_.end()) return -1;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(nearest->until - Clock::now());
  return static_cast<int>(std::max<std::int64_t>(left.count(), 0));
}

void FrontDoor::pollGuests(Host& host) {
  std::vector<pollfd> pollers{{listening_.get(), POLLIN, 0}, {wake_.get(), POLLIN, 0}};
  for (const Guest& guest : guests_) pollers.push_back({guest.connection->fd(), POLLIN, 0});
  if (::poll(pollers.data(), pollers.size(), waitingTime_ms()) < 0 && errno != EINTR)
    throw std::system_error(errno, std::generic_category(), "poll");
  const auto now = Clock::now();
  auto poller = pollers.begin() + 2;
  for (auto guest = guests_.begin(); guest != guests_.end(); ++poller) {
    const bool stays = poller->revents != 0 ? look(host, *guest) : guest->until > now;
    guest = stays ? std::next(guest) : guests_.erase(guest);
  }
  if (pollers[1].revents != 0) takeReturned(host);
  if (pollers[0].revents != 0) acceptAll();
}

void FrontDoor::acceptAll() {
  while (true) {
    const int fd = ::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
      if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
        letOldestGo();
        (void)::poll(nullptr, 0, kRest_ms);
      }
      return;
    }
    const int on = 1;
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    std::size_t at_work = 0;
    {
      const std::lock_guard lock(mutex_);
      at_work = at_work_.size() + tasks_.size();
    }
    if (guests_.size() + at_work >= limits_.most_connections) letOldestGo();
    guests_.push_back(
        {std::make_unique<Connection>(base::UniqueFd(fd)), Clock::now() + limits_.head, false, false});
  }
}

void FrontDoor::letOldestGo() {
  if (!guests_.empty()) guests_.pop_front();
}

bool FrontDoor::look(Host& host, Guest& guest) {
  Connection& connection = *guest.connection;
  const bool is_open = connection.receive(kMostHeadBytes + 1);
  if (guest.is_leaving) {
    connection.drop(connection.pending().size());
    return is_open && guest.until > Clock::now();
  }
  if (!guest.has_begun && !connection.pending().empty()) {
    guest.has_begun = true;
    guest.until = Clock::now() + limits_.head;
  }
  return lookAtHead(host, guest) && (is_open || !guest.connection);
}

bool FrontDoor::lookAtHead(Host& host, Guest& guest) {
  Connection& connection = *guest.connection;
  const std::optional<std::size_t> length = headLength(connection.pending());
  try {
    if (!length && connection.pending().size() > kMostHeadBytes)
      throw Refusal(431, "The head of the request is too long.");
    if (!length) return guest.until > Clock::now();
    HttpHead head = parseHead(connection.pending().substr(0, *length));
    const bool is_known = host.admit(head);
    connection.drop(*length);
    return handOver(host, guest, std::move(head), is_known);
  } catch (const Refusal& refusal) {
    return refuse(guest, refusal.status(), refusal.what());
  }
}

bool FrontDoor::refuse(Guest& guest, int status, const std::string& sentence) {
  // A socket that is closed with something unread takes its answer back; so the client may speak on for a
  // while.
  Connection& connection = *guest.connection;
  connection.writeAtOnce(refusalBytes(status, sentence));
  connection.endWriting();
  connection.drop(connection.pending().size());
  guest.is_leaving = true;
  guest.until = Clock::now() + limits_.leave;
  return true;
}

bool FrontDoor::handOver(Host& host, Guest& guest, HttpHead head, bool is_known) {
  std::unique_lock lock(mutex_);
  if (stopping_) return false;
  const bool is_full = tasks_.size() + at_work_.size() >= 2 * limits_.most_at_work;
  if (is_full || (!is_known && strangers_at_work_ >= limits_.most_strangers)) {
    lock.unlock();
    return refuse(guest, 503, "This server has too much to do. Try again in a moment.");
  }
  if (!is_known) ++strangers_at_work_;
  tasks_.push_back({std::move(guest.connection), std::move(head), is_known});
  if (idle_threads_ < tasks_.size() && threads_.size() < limits_.most_at_work)
    threads_.emplace_back([this, &host] { work(host); });
  task_there_.notify_one();
  return false;
}

void FrontDoor::takeReturned(Host& host) {
  std::uint64_t count = 0;
  (void)!::read(wake_.get(), &count, sizeof count);
  std::vector<std::unique_ptr<Connection>> back;
  {
    const std::lock_guard lock(mutex_);
    back.swap(returned_);
  }
  for (std::unique_ptr<Connection>& connection : back) {
    guests_.push_back({std::move(connection), Clock::now() + limits_.idle, false, false});
    // The next request may have come along with the last one.
    if (!guests_.back().connection->pending().empty() && !look(host, guests_.back())) guests_.pop_back();
  }
}

void FrontDoor::work(Host& host) {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_threads_;
    task_there_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
    --idle_threads_;
    if (stopping_) return;
    Task task = std::move(tasks_.front());
    tasks_.pop_front();
    Connection* const connection = task.connection.get();
    at_work_.insert(connection);
    lock.unlock();
    const bool stays = host.serve(*connection, task.head, task.is_known);
    lock.lock();
    at_work_.erase(connection);
    if (!task.is_known) --strangers_at_work_;
    if (!stays || stopping_) continue;
    returned_.push_back(std::move(task.connection));
    const std::uint64_t one = 1;
    (void)!::write(wake_.get(), &one, sizeof one);
  }
}

void FrontDoor::endWork() {
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (const Connection* connection : at_work_) connection->cut();
    threads.swap(threads_);
    task_there_.notify_all();
  }
  for (std::thread& thread : threads) thread.join();
  guests_.clear();
  tasks_.clear();
  returned_.clear();
}

}  // namespace kerfbench::serve
