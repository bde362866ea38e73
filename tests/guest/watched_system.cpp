// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/watched_system.h"

#include <linux/gpio.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace kerfbench::guest {

source::KernelAnswer WatchedSystem::read(int fd, std::span<std::byte> into) {
  const source::KernelAnswer got = real_->read(fd, into);
  const std::uint64_t now_ns = real_->now_ns();
  std::array<gpio_v2_line_event, 64> events{};
  if (got.failed() || into.size() > sizeof events) return got;
  std::memcpy(events.data(), into.data(), into.size());
  for (const gpio_v2_line_event& event :
       std::span(events).first(static_cast<std::size_t>(got.value) / sizeof events[0])) {
    numbers_.push_back(event.seqno);
    worst_delay_ns_ = std::max<std::uint64_t>(worst_delay_ns_, now_ns - event.timestamp_ns);
  }
  return got;
}

source::KernelAnswer WatchedSystem::poll(int fd, std::uint64_t timeout_ns, short& revents) {
  if (before_first_wait_) std::exchange(before_first_wait_, nullptr)();
  return real_->poll(fd, timeout_ns, revents);
}

std::vector<int> interruptThreads() {
  std::vector<std::pair<int, int>> threads;  // Threads by the interrupt's number.
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "comm");
    std::string name;
    int interrupt = 0;
    if (std::getline(file, name) && std::sscanf(name.c_str(), "irq/%d-kerfbench", &interrupt) == 1 &&
        name.ends_with("-kerfbench"))
      threads.emplace_back(interrupt, std::stoi(entry.path().filename().string()));
  }
  std::ranges::sort(threads);
  std::vector<int> numbers;
  for (const auto& [interrupt, thread] : threads) numbers.push_back(thread);
  return numbers;
}

}  // namespace kerfbench::guest
