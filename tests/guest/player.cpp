// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/player.h"

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <system_error>
#include <utility>

#include "hil/source/gpio/chips.h"

namespace kerfbench::guest {
namespace {

constexpr std::uint64_t kLook_ns = 1'000'000;
constexpr std::uint64_t kSettle_ns = 5'000'000;  // A reader takes levels and clock once it has the lines.
constexpr std::uint64_t kShortest_ns = 20'000;   // Shortest time for which the player sleeps.

void waitForListener(const SimChip& chip) {
  const auto is_heard = [](const source::GpioLineInfo& line) { return line.consumer == "kerfbench"; };
  while (std::ranges::none_of(source::readChip(chip.device()).lines, is_heard))
    sleepUntil_ns(now_ns() + kLook_ns);
  sleepUntil_ns(now_ns() + kSettle_ns);
}

}  // namespace

std::uint64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec);
}

void sleepUntil_ns(std::uint64_t at_ns) {
  const timespec at{static_cast<time_t>(at_ns / 1'000'000'000U), static_cast<long>(at_ns % 1'000'000'000U)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
}

void setRealTime(int thread, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (::sched_setscheduler(thread, SCHED_FIFO, &parameters) != 0)
    throw std::system_error(errno, std::generic_category(), "sched_setscheduler");
}

Player::Player(SimChip& chip, std::vector<Stroke> strokes, PlayerOptions options)
    : chip_(chip), strokes_(std::move(strokes)), options_(std::move(options)), thread_([this] {
        try {
          play();
        } catch (...) {
          fault_ = std::current_exception();
        }
      }) {}

void Player::play() {
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  waitForListener(chip_);
  if (options_.before) options_.before();
  if (options_.real_time_priority > 0) setRealTime(0, options_.real_time_priority);
  played_.pulled_ns.reserve(strokes_.size());
  played_.begin_ns = now_ns();
  for (const Stroke& stroke : strokes_) {
    const std::uint64_t due_ns = played_.begin_ns + stroke.at_ns;
    if (due_ns > now_ns() + kShortest_ns) sleepUntil_ns(due_ns);
    while (now_ns() < due_ns) {
    }
    played_.pulled_ns.push_back(now_ns());
    played_.worst_late_ns = std::max(played_.worst_late_ns, played_.pulled_ns.back() - due_ns);
    chip_.pull(stroke.line, stroke.level);
  }
  played_.end_ns = now_ns();
}

Played Player::join() {
  if (thread_.joinable()) thread_.join();
  if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
  return played_;
}

}  // namespace kerfbench::guest
