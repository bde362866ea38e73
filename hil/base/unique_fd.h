// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <utility>

namespace kerfbench::base {

/// A file descriptor with one owner, move-only. `Closer` is called with the descriptor when the owner ends.
template <class Closer>
class OwnedFd {
 public:
  OwnedFd() = default;
  explicit OwnedFd(int fd, Closer closer = {}) : fd_(fd), closer_(std::move(closer)) {}
  OwnedFd(OwnedFd&& other) noexcept : fd_(other.release()), closer_(std::move(other.closer_)) {}
  OwnedFd& operator=(OwnedFd&& other) noexcept {
    if (this == &other) return *this;
    reset();
    fd_ = other.release();
    closer_ = std::move(other.closer_);
    return *this;
  }
  ~OwnedFd() { reset(); }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }
  /// Gives the descriptor away, unclosed.
  int release() { return std::exchange(fd_, -1); }
  void reset() {
    // The analyzer of clang 14 knows no structured bindings of a pair and takes what they held for garbage.
    // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
    if (fd_ >= 0) closer_(release());
  }

 private:
  int fd_{-1};
  Closer closer_{};
};

/// Closes by the kernel's close(2).
struct KernelClose {
  void operator()(int fd) const { (void)::close(fd); }
};
using UniqueFd = OwnedFd<KernelClose>;

/// Closes by a system that a test can take the place of; `Pointer` points to it.
template <class Pointer>
struct SystemClose {
  Pointer system{};
  void operator()(int fd) const { (void)system->close(fd); }
};

}  // namespace kerfbench::base
