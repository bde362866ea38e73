// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/gpio.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// A scripted kernel: one chip with twelve free lines, and edges at given times. Each answer can be replaced.
/// Its clock stands still except in poll(), which takes as long as it waits, and where a test advances it.
class ScriptedKernel : public GpioSystem {
 public:
  static constexpr std::uint32_t kLines = 12;
  static constexpr std::uint64_t kStart_ns = 1'000'000'000;
  /// List as from listChips(): /dev/gpiochip0.
  static GpioChipList listed();

  // Answers of the kernel.
  int open_error{};
  int chip_error{};
  int line_info_error{};
  int request_error{};
  int levels_error{};
  int poll_error{};  ///< Error of the next poll; then all is well again.
  short poll_revents{};
  int read_error{};               ///< Error of the next read.
  std::vector<int> read_bytes{};  ///< Sizes of the next reads; without them a read takes all that there is.
  int output_error{};             ///< Error of a request for outputs.
  int set_error{};
  std::uint64_t read_takes_ns{};  ///< Processor time of a read.
  std::uint64_t set_takes_ns{};   ///< Time by which the clock advances when lines are driven.
  int priority_error{};
  int lock_error{};
  std::map<std::uint32_t, std::string> taken;  ///< Lines with their consumers.
  std::uint64_t level_bits{};                  ///< Levels of the lines in the order of the request.

  // Record of the calls.
  gpio_v2_line_request request{};  ///< Request for inputs.
  gpio_v2_line_request output_request{};
  struct Driven {
    std::uint64_t at_ns{};  ///< Time of the call.
    std::uint64_t mask{};   ///< Mask of the lines in the order of the request.
    std::uint64_t bits{};
    friend bool operator==(const Driven&, const Driven&) = default;
  };
  std::vector<Driven> driven;
  std::vector<int> open_fds;
  int real_time{};  ///< Balance: +1 by setRealTime(), 0 by leaveRealTime().

  /// Adds an edge to the kernel's buffer from `at_ns` on.
  void edge(std::uint64_t stamp_ns, std::uint32_t offset, bool rising, std::uint32_t seqno,
            std::uint32_t line_seqno, std::uint64_t at_ns);
  /// Adds an edge with number and level as a good kernel does; the buffer has it at once.
  void toggle(std::uint64_t stamp_ns, std::uint32_t offset);
  /// Called before each poll(), with the time.
  std::function<void(std::uint64_t)> before_poll;

  KernelAnswer open(const std::string& path) override;
  KernelAnswer control(int fd, unsigned long request_code, void* argument) override;
  KernelAnswer read(int fd, std::span<std::byte> into) override;
  KernelAnswer poll(int fd, std::uint64_t timeout_ns, short& revents) override;
  void close(int fd) override;
  std::uint64_t now_ns() override { return now_; }
  /// Processor time: each read of edges takes `read_takes_ns` of it; the clock does not advance.
  std::uint64_t threadTime_ns() override { return thread_time_; }
  /// Advances the clock, as if a computation took time.
  void passTime(std::uint64_t by_ns) { now_ += by_ns; }
  KernelAnswer setRealTime(int priority) override;
  KernelAnswer lockMemory() override;
  void leaveRealTime() override { real_time = 0; }
  /// Level of a line, as toggle() left it.
  [[nodiscard]] bool levelOf(std::uint32_t offset) const {
    const auto found = level_.find(offset);
    return found != level_.end() && found->second;
  }

 protected:
  void forgetEdges() { buffer_.clear(); }
  std::uint64_t now_{kStart_ns};
  std::uint64_t thread_time_{};

 private:
  struct Buffered {
    std::uint64_t at_ns{};
    gpio_v2_line_event event{};
  };
  KernelAnswer give(int fd);
  KernelAnswer giveLines(gpio_v2_line_request& wanted);

  std::deque<Buffered> buffer_;
  std::map<std::uint32_t, std::uint32_t> line_seqno_;
  std::map<std::uint32_t, bool> level_;
  std::uint32_t seqno_{};
  int next_fd_{100};
};

}  // namespace kerfbench::source
