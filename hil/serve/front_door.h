// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_set>
#include <vector>

#include "hil/base/unique_fd.h"
#include "hil/serve/access.h"
#include "hil/serve/connection.h"
#include "hil/serve/http_head.h"

namespace kerfbench::serve {

/// What clients may take. Times are of the wall clock.
struct DoorLimits {
  std::size_t most_connections{384};       ///< At the door and at work; below the usual 1024 descriptors.
  std::size_t most_at_work{96};            ///< Requests that have a thread each.
  std::size_t most_strangers{16};          ///< Requests at work of browsers that have not been let in.
  std::chrono::milliseconds head{10'000};  ///< For all of a head, from its first byte on.
  std::chrono::milliseconds idle{60'000};  ///< Between two requests.
  std::chrono::milliseconds leave{2'000};  ///< For a client that was refused to read the answer.
};

/// Who decides at the door, and who answers behind it.
class Host {
 public:
  virtual ~Host() = default;
  /// Whether the client is known. Called by the door's thread: it must not wait for anything.
  /// @throws Refusal, which the door tells the client before it reads anything of a body.
  virtual bool admit(const HttpHead& head) = 0;
  /// Reads the body, answers. False: the connection is of no further use. Called by many threads.
  virtual bool serve(Connection& connection, const HttpHead& head, bool is_known) = 0;
};

/// Listens, and waits for the heads of requests: a thread looks after all clients that have not sent one yet,
/// however slow they are, and only a whole and proper head that Host::admit() lets pass gets a thread. When
/// there are too many clients, the one that waits the longest is let go, never the newest.
class FrontDoor {
 public:
  /// Binds and listens. Port 0: one that is free. @throws base::InputError if the address or port cannot be
  /// had.
  FrontDoor(const ServerAddress& wanted, const DoorLimits& limits);
  ~FrontDoor();
  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;

  /// As bound.
  [[nodiscard]] const ServerAddress& address() const { return address_; }
  /// The listening socket.
  [[nodiscard]] int fd() const { return listening_.get(); }

  /// Serves until stop() is called; then all connections are cut, and all that was at work has ended.
  void run(Host& host);
  /// From any thread.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  struct Guest {
    std::unique_ptr<Connection> connection;
    Clock::time_point until;
    bool is_leaving{};  ///< Was answered by the door; what it still sends is thrown away.
    bool has_begun{};   ///< Some of a head is there.
  };
  struct Task {
    std::unique_ptr<Connection> connection;
    HttpHead head;
    bool is_known{};
  };

  void acceptAll();
  /// False: the guest is to be removed.
  bool look(Host& host, Guest& guest);
  bool lookAtHead(Host& host, Guest& guest);
  bool refuse(Guest& guest, int status, const std::string& sentence);
  void letOldestGo();
  void takeReturned(Host& host);
  bool handOver(Host& host, Guest& guest, HttpHead head, bool is_known);
  void work(Host& host);
  [[nodiscard]] int waitingTime_ms() const;
  void pollGuests(Host& host);
  void endWork();

  ServerAddress address_;
  DoorLimits limits_;
  base::UniqueFd listening_;
  base::UniqueFd wake_;
  std::list<Guest> guests_;  ///< The longest wait first; the door's thread alone uses it.

  std::mutex mutex_;
  std::condition_variable task_there_;
  std::deque<Task> tasks_;
  std::vector<std::unique_ptr<Connection>> returned_;  ///< Answered, and to wait for the next request.
  std::unordered_set<Connection*> at_work_;
  std::size_t strangers_at_work_{};
  std::size_t idle_threads_{};
  std::vector<std::thread> threads_;
  bool stopping_{};
};

/// An answer of JSON in the bytes of HTTP, after which the connection ends.
std::string refusalBytes(int status, const std::string& sentence);

}  // namespace kerfbench::serve
