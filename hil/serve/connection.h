// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "hil/base/unique_fd.h"

namespace kerfbench::serve {

/// A client's connection: a socket that does not block, and what came of it and was not read yet. To be used
/// by one thread at a time, but for cut().
class Connection {
 public:
  explicit Connection(base::UniqueFd socket);

  [[nodiscard]] int fd() const { return socket_.get(); }
  /// What came and was not taken yet.
  [[nodiscard]] std::string_view pending() const { return pending_; }
  void drop(std::size_t bytes) { pending_.erase(0, bytes); }

  /// Takes what has come, without waiting, until `most` bytes are pending. False: the client has ended its
  /// side, or the connection.
  bool receive(std::size_t most);
  /// Up to `size` bytes, of what is pending first; waits for them at most so long. 0: the client has ended
  /// its side; -1: nothing came in time, or the connection broke.
  std::ptrdiff_t read(char* to, std::size_t size, double wait_s);
  /// Sends all; false if the client has taken nothing for `wait_s`, or has gone.
  bool write(std::string_view bytes, double wait_s);
  /// Sends what the socket takes at once.
  void writeAtOnce(std::string_view bytes);
  /// Whether the client has gone: has closed its connection, or it broke.
  [[nodiscard]] bool isGone() const;
  /// Tells the client that nothing more comes.
  void endWriting();
  /// Ends the connection, also while another thread waits for it.
  void cut() const;

 private:
  base::UniqueFd socket_;
  std::string pending_;
};

}  // namespace kerfbench::serve
