// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/gpio/scripted_kernel.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace kerfbench::source {
namespace {

KernelAnswer no(int error) { return {-1, error}; }

}  // namespace

GpioChipList ScriptedKernel::listed() {
  GpioChipInfo chip{"/dev/gpiochip0", "gpiochip0", "script", {}};
  for (std::uint32_t i = 0; i < kLines; ++i) chip.lines.push_back({i, "", "", false, false, false});
  return {{chip}, {}};
}

void ScriptedKernel::edge(std::uint64_t stamp_ns, std::uint32_t offset, bool rising, std::uint32_t seqno,
                          std::uint32_t line_seqno, std::uint64_t at_ns) {
  gpio_v2_line_event event{};
  event.timestamp_ns = stamp_ns;
  event.id = rising ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
  event.offset = offset;
  event.seqno = seqno;
  event.line_seqno = line_seqno;
  buffer_.push_back({at_ns, event});
}

void ScriptedKernel::toggle(std::uint64_t stamp_ns, std::uint32_t offset) {
  bool& level = level_[offset];
  level = !level;
  edge(stamp_ns, offset, level, ++seqno_, ++line_seqno_[offset], stamp_ns);
}

KernelAnswer ScriptedKernel::give(int fd) {
  open_fds.push_back(fd);
  return {fd, 0};
}

KernelAnswer ScriptedKernel::open(const std::string& /*path*/) {
  return open_error != 0 ? no(open_error) : give(next_fd_++);
}

void ScriptedKernel::close(int fd) { std::erase(open_fds, fd); }

KernelAnswer ScriptedKernel::control(int /*fd*/, unsigned long request_code, void* argument) {
  if (request_code == GPIO_GET_CHIPINFO_IOCTL) {
    if (chip_error != 0) return no(chip_error);
    static_cast<gpiochip_info*>(argument)->lines = kLines;
    return {};
  }
  if (request_code == GPIO_V2_GET_LINEINFO_IOCTL) {
    if (line_info_error != 0) return no(line_info_error);
    auto* info = static_cast<gpio_v2_line_info*>(argument);
    if (const auto found = taken.find(info->offset); found != taken.end()) {
      info->flags = GPIO_V2_LINE_FLAG_USED;
      std::strncpy(info->consumer, found->second.c_str(), GPIO_MAX_NAME_SIZE - 1);
    }
    return {};
  }
  if (request_code == GPIO_V2_GET_LINE_IOCTL) return giveLines(*static_cast<gpio_v2_line_request*>(argument));
  if (request_code == GPIO_V2_LINE_SET_VALUES_IOCTL) {
    if (set_error != 0) return no(set_error);
    const auto* values = static_cast<const gpio_v2_line_values*>(argument);
    driven.push_back({now_, values->mask, values->bits});
    now_ += set_takes_ns;
    return {};
  }
  if (request_code != GPIO_V2_LINE_GET_VALUES_IOCTL) return no(ENOTTY);
  if (levels_error != 0) return no(levels_error);
  auto* values = static_cast<gpio_v2_line_values*>(argument);
  values->bits = level_bits & values->mask;
  return {};
}

KernelAnswer ScriptedKernel::giveLines(gpio_v2_line_request& wanted) {
  const bool output = (wanted.config.flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0;
  if (const int error = output ? output_error : request_error; error != 0) return no(error);
  wanted.fd = next_fd_++;
  (output ? output_request : request) = wanted;
  return give(wanted.fd);
}

KernelAnswer ScriptedKernel::poll(int fd, std::uint64_t timeout_ns, short& revents) {
  if (before_poll) before_poll(now_);
  if (fd < 0) {
    now_ += timeout_ns;
    revents = 0;
    return {};
  }
  if (poll_error != 0) return no(std::exchange(poll_error, 0));
  revents = poll_revents;
  if (revents != 0) return {1, 0};
  const std::uint64_t until = now_ + timeout_ns;
  const bool any = !buffer_.empty() && buffer_.front().at_ns <= until;
  now_ = any ? std::max(now_, buffer_.front().at_ns) : until;
  revents = any ? POLLIN : 0;
  return {any ? 1 : 0, 0};
}

KernelAnswer ScriptedKernel::read(int /*fd*/, std::span<std::byte> into) {
  thread_time_ += read_takes_ns;
  if (read_error != 0) return no(std::exchange(read_error, 0));
  if (!read_bytes.empty()) {
    const int bytes = read_bytes.front();
    read_bytes.erase(read_bytes.begin());
    return {bytes, 0};
  }
  std::size_t filled = 0;
  while (!buffer_.empty() && buffer_.front().at_ns <= now_ &&
         filled + sizeof(gpio_v2_line_event) <= into.size()) {
    std::memcpy(into.data() + filled, &buffer_.front().event, sizeof(gpio_v2_line_event));
    filled += sizeof(gpio_v2_line_event);
    buffer_.pop_front();
  }
  return filled == 0 ? no(EAGAIN) : KernelAnswer{static_cast<int>(filled), 0};
}

KernelAnswer ScriptedKernel::setRealTime(int /*priority*/) {
  if (priority_error != 0) return no(priority_error);
  real_time = 1;
  return {};
}

KernelAnswer ScriptedKernel::lockMemory() { return lock_error != 0 ? no(lock_error) : KernelAnswer{}; }

}  // namespace kerfbench::source
