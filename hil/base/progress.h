// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace kerfbench::base {

/// Called now and then with the virtual time (< 0: none) and a word on what happens.
using ProgressFn = std::function<void(double now_s, const std::string& what)>;

/// Progress of a work of known size, in per cent; works that take no time are not told.
class ShareProgress {
 public:
  static constexpr std::uint64_t kLeast = std::uint64_t{4} << 20U;  ///< Bytes that are read in an instant.

  /// `told` may be empty. `what`: for example "reading pins.vcd". `least`: of the total, the amount that
  /// takes no time, and the least between two words.
  ShareProgress(ProgressFn told, std::string what, std::uint64_t total, std::uint64_t least = kLeast)
      : told_(std::move(told)), what_(std::move(what)), total_(total), least_(least), next_(least) {}

  void done(std::uint64_t amount) {
    if (!told_ || amount < next_ || total_ == 0) return;
    next_ = amount + total_ / 100 + least_;
    told_(-1.0, what_ + ", " + std::to_string(amount * 100 / total_) + " %");
  }

 private:
  ProgressFn told_;
  std::string what_;
  std::uint64_t total_{};
  std::uint64_t least_{};
  std::uint64_t next_{};
};

}  // namespace kerfbench::base
