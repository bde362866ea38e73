// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace kerfbench::source {

/// A serial line that cannot be used, or no longer; what() says in words what to do.
class SerialError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Answer of the kernel: a value >= 0, or -1 and an errno.
struct SerialAnswer {
  long value{};
  int error{};
  [[nodiscard]] bool failed() const { return value < 0; }
};

/// The system calls of a serial line, so that tests give every answer that a kernel can give.
class SerialSystem {
 public:
  virtual ~SerialSystem() = default;
  /// Opens for reading and writing, without waiting for a carrier, without becoming the controlling terminal;
  /// reads and writes never wait.
  virtual SerialAnswer open(const std::string& path) = 0;
  virtual SerialAnswer control(int fd, unsigned long request, void* argument) = 0;
  virtual SerialAnswer read(int fd, std::span<std::byte> into) = 0;
  virtual SerialAnswer write(int fd, std::span<const std::byte> bytes) = 0;
  virtual void close(int fd) = 0;
};
/// The real ones.
std::shared_ptr<SerialSystem> linuxSerialSystem();

}  // namespace kerfbench::source
