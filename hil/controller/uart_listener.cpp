// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/uart_listener.h"

#include <algorithm>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::controller {
namespace {

static_assert(UartListener::kAxes == KB_AXES);
constexpr std::size_t kHead = 4;  // SYNC TYPE SEQ LEN

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000U) != 0 ? (crc << 1) ^ 0x1021U : crc << 1;
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

long long int32At(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{bytes[at + i]} << (8 * i);
  return static_cast<std::int32_t>(value);
}

}  // namespace

std::vector<std::string> faultNames() {
  return {"ok",    "dry",    "interlock", "limit",   "program",   "overspeed", "late",
          "marks", "silent", "uart",      "encoder", "belt-fast", "watchdog",  "field"};
}

std::string faultName(std::uint8_t fault) {
  const auto names = faultNames();
  return fault < names.size() ? names[fault] : "unknown";
}

UartListener::UartListener(const source::PinRecording& recording) {
  for (const source::ReceivedBytes& received : recording.uart)
    hear(received.bytes, recording.rate.seconds(received.tick));
}

void UartListener::hear(std::span<const std::uint8_t> bytes, double now_s) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  for (;;) {
    const auto sync = std::ranges::find(pending_, KB_SYNC);
    stray_bytes_ += static_cast<std::size_t>(sync - pending_.begin());
    pending_.erase(pending_.begin(), sync);
    if (pending_.size() < kHead) return;
    const std::size_t end = kHead + pending_[3];
    if (pending_[3] <= KB_PAYLOAD_MAX && pending_.size() < end + 2) return;
    const std::span<const std::uint8_t> whole(pending_);
    const bool good = pending_[3] <= KB_PAYLOAD_MAX &&
                      crc16(whole.subspan(1, end - 1)) == (pending_[end] | pending_[end + 1] << 8);
    if (good) frame(pending_[1], whole.subspan(kHead, end - kHead), now_s);
    stray_bytes_ += good ? 0U : 1U;
    pending_.erase(pending_.begin(), pending_.begin() + (good ? static_cast<std::ptrdiff_t>(end + 2) : 1));
  }
}

void UartListener::frame(std::uint8_t type, std::span<const std::uint8_t> payload, double now_s) {
  if ((type == KB_EVENT && payload.size() == 2) || (type == KB_STATE && payload.size() >= 2)) {
    const inspect::ControllerState report{now_s, payload[0] == KB_STOPPED, faultName(payload[1])};
    const bool news = reports_.empty() || reports_.back().stopped != report.stopped ||
                      reports_.back().fault != report.fault;
    if (news) reports_.push_back(report);
    const bool ended = payload[0] == KB_DONE || payload[0] == KB_STOPPED;
    if (ended && !end_) end_ = {now_s, payload[0] == KB_DONE, payload[1]};
  }
  if (type != KB_STATE || payload.size() != 8 + 4 * kAxes) return;
  const BeltWord belt{now_s, int32At(payload, 4)};
  if (!first_belt_) first_belt_ = belt;
  if (payload[0] == KB_RUNNING) return;
  Account account{*first_belt_, belt, {}};
  for (std::size_t axis = 0; axis < kAxes; ++axis) account.steps[axis] = int32At(payload, 8 + 4 * axis);
  account_ = account;
}

}  // namespace kerfbench::controller
