// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/live/board_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <utility>

namespace kerfbench::live {
namespace {

constexpr std::uint64_t kStep_ns = 200'000;
constexpr std::uint64_t kSecond_ns = 1'000'000'000;
constexpr std::size_t kPacket = 62;  // Size of a packet: two of an FTDI's 64 bytes are its status.
__extension__ using Wide = unsigned __int128;

}  // namespace

BoardKernel::BoardKernel(std::unique_ptr<source::SignalSource> release, const SignalMap& pins, Wiring wiring)
    : release_(std::move(release)), rate_(release_->info().rate), pins_(pins), wiring_(std::move(wiring)) {
  for (const auto& [line, signal] : wiring_) {
    if (!isSensor(signal)) line_of_[pins_.pin(signal).value()] = line;
  }
}

Tick BoardKernel::tickAt(std::uint64_t now_ns) const {
  return static_cast<Tick>(Wide{now_ns - kStart_ns} * rate_.den / (Wide{rate_.num} * kSecond_ns));
}

/// First ns after the tick.
std::uint64_t BoardKernel::stampOf(Tick tick) const {
  return kStart_ns +
         static_cast<std::uint64_t>((Wide{tick} * rate_.num * kSecond_ns + rate_.den - 1) / rate_.den);
}

source::KernelAnswer BoardKernel::control(int fd, unsigned long request_code, void* argument) {
  if (request_code == GPIO_V2_LINE_GET_VALUES_IOCTL) {
    level_bits = 0;
    for (std::uint32_t i = 0; i < request.num_lines; ++i) {
      if (levelOf(request.offsets[i])) level_bits |= std::uint64_t{1} << i;
    }
  }
  const source::KernelAnswer answer = source::ScriptedKernel::control(fd, request_code, argument);
  if (answer.failed()) return answer;
  if (request_code == GPIO_V2_LINE_SET_VALUES_IOCTL) {
    const auto* values = static_cast<const gpio_v2_line_values*>(argument);
    driveLines(output_request, values->mask, values->bits);
  } else if (request_code == GPIO_V2_GET_LINE_IOCTL && output_request.num_lines > 0) {
    const auto& at_first = output_request.config.attrs[0];
    driveLines(output_request, at_first.mask, at_first.attr.values);
  }
  return answer;
}

void BoardKernel::driveLines(const gpio_v2_line_request& lines, std::uint64_t mask, std::uint64_t bits) {
  for (std::uint32_t i = 0; i < lines.num_lines; ++i) {
    if ((mask >> i & 1U) == 0) continue;
    last_drive_ = std::max({last_drive_, tickAt(now_ns()), batch_.watermark + 1});
    release_->drive(pins_.pin(wiring_.at(lines.offsets[i])).value(), (bits >> i & 1U) != 0, last_drive_);
  }
}

source::KernelAnswer BoardKernel::poll(int fd, std::uint64_t timeout_ns, short& revents) {
  const std::uint64_t goal_ns = now_ns() + timeout_ns;
  for (;;) {
    // The time may have passed elsewhere.
    runTo(now_ns());
    const source::KernelAnswer answer = source::ScriptedKernel::poll(fd, 0, revents);
    if (answer.failed() || revents != 0 || now_ns() >= goal_ns) return answer;
    runTo(std::min(goal_ns, now_ns() + kStep_ns));
  }
}

void BoardKernel::runTo(std::uint64_t goal_ns) {
  if (serial_->from_bench.size() > sent_) {
    release_->uartWrite(std::span(serial_->from_bench).subspan(sent_));
    sent_ = serial_->from_bench.size();
  }
  if (const Tick until = tickAt(goal_ns); until > batch_.watermark) {
    EXPECT_EQ(release_->advance(until, batch_), source::Stop::kReached) << release_->message();
    for (const PinEvent& event : batch_.events) takeEvent(event);
    held_.insert(held_.end(), batch_.uart.begin(), batch_.uart.end());
  }
  handOver(goal_ns);
  passTime(goal_ns - now_ns());
}

void BoardKernel::handOver(std::uint64_t now) {
  if (now - last_packet_ns_ < serial_latency_ns && held_.size() < kPacket) return;
  serial_->to_bench.insert(serial_->to_bench.end(), held_.begin(), held_.end());
  held_.clear();
  last_packet_ns_ = now;
}

void BoardKernel::takeEvent(const PinEvent& event) {
  for (std::uint16_t bit = 0; bit < 16; ++bit) {
    if ((event.changed >> bit & 1U) == 0) continue;
    const auto line = line_of_.find({event.port, bit});
    if (line != line_of_.end()) toggle(stampOf(event.tick), line->second);
  }
}

}  // namespace kerfbench::live
