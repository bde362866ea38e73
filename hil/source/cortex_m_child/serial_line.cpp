// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/serial_line.h"

#include <algorithm>
#include <cstdio>

namespace kerfbench::cortex_m_child {

SerialLine::SerialLine(Present& present, const CoreTime& time, const Usarts& usarts, UsbDevice& usb,
                       std::uint32_t baud)
    : present_(present),
      time_(time),
      usarts_(usarts),
      baud_(baud),
      usb_host_(present, time, usb, to_send_, baud),
      pace_(time.clockHz(), baud) {
  usb_host_.on_bytes = [this](std::span<const std::uint8_t> bytes, std::uint64_t tick) {
    for (const std::uint8_t byte : bytes) sent_.push_back({tick, byte});
  };
}

/// A device that is no serial line leaves the line to the USARTs.
bool SerialLine::isOnUsb() const {
  const UsbHost::State state = usb_host_.state();
  return state == UsbHost::State::kOpening || state == UsbHost::State::kOpen;
}

Usart* SerialLine::receiver() const {
  const auto found = std::ranges::find_if(usarts_, [](const auto& usart) { return usart->receives(); });
  return found == usarts_.end() ? nullptr : found->get();
}

void SerialLine::send(std::span<const std::uint8_t> bytes, std::uint64_t watermark_tick) {
  if (to_send_.empty() && free_at_ < watermark_tick) {
    free_at_ = watermark_tick;
    pace_.restart();
  }
  to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
  checkUsb();
}

std::uint64_t SerialLine::nextFrameTick() const {
  if (to_send_.empty()) return kNever;
  if (in_frame_) return free_at_;
  if (isOnUsb()) return kNever;
  const Usart* usart = receiver();
  return usart != nullptr && usart->holdsOff() ? kNever : free_at_;
}

std::uint64_t SerialLine::nextTick() { return std::min(nextFrameTick(), usb_host_.nextTick()); }

void SerialLine::run() {
  if (nextFrameTick() <= usb_host_.nextTick()) return runUsart();
  usb_host_.run();
  checkUsb();
}

/// Where the bench can be heard nowhere.
void SerialLine::checkUsb() {
  if (usb_host_.state() != UsbHost::State::kRefused || receiver() != nullptr || !present_.misheard.empty())
    return;
  if (!usb_host_.isSilentRefusal() || !to_send_.empty()) present_.misheard = usb_host_.refusal();
}

void SerialLine::runUsart() {
  Usart* const usart = receiver();
  if (!in_frame_) {
    in_frame_ = true;
    // After RTS has held it off, the line has been idle: no catching up.
    free_at_ = std::max(free_at_, time_.tickOf(present_.cycle)) + pace_.next();
    if (usart != nullptr) usart->beginReceiving();
    return;
  }
  in_frame_ = false;
  const std::uint8_t byte = to_send_.front();
  to_send_.pop_front();
  if (usart == nullptr) return;  // Nobody listens: the byte is lost, as on silicon.
  watch(*usart);
  usart->receive(byte);
}

void SerialLine::onTransmit(const Usart& usart, std::uint8_t byte, Cycle end) {
  if (isOnUsb()) return;
  const Usart* own = receiver();
  if (own != nullptr && own != &usart) return;
  watch(usart);
  sent_.push_back({time_.tickOf(end), byte});
}

/// A byte is under way: whether it would be heard.
void SerialLine::watch(const Usart& usart) {
  if (!present_.misheard.empty()) return;
  const double rate =
      static_cast<double>(time_.coreHz()) / static_cast<double>(std::max<Cycle>(1, usart.cyclesPerBit()));
  char text[200] = "";
  if (emulator::missesBytes(rate, baud_)) {
    std::snprintf(
        text, sizeof text,
        "the firmware's USART%u runs at %.0f baud, with a core clock of %llu Hz, and the bench at %u",
        usart.number(), rate, static_cast<unsigned long long>(time_.coreHz()), baud_);
  } else if (usart.bitsPerFrame() != emulator::kBitsPerByte) {
    std::snprintf(text, sizeof text,
                  "a byte of the firmware's USART%u takes %u bits, and the bench has 10 (8N1)",
                  usart.number(), usart.bitsPerFrame());
  }
  present_.misheard = text;
}

std::vector<std::uint8_t> SerialLine::takeSent(std::uint64_t until_tick) {
  std::vector<std::uint8_t> bytes;
  while (!sent_.empty() && sent_.front().done_at <= until_tick) {
    bytes.push_back(sent_.front().byte);
    sent_.pop_front();
  }
  return bytes;
}

}  // namespace kerfbench::cortex_m_child
