// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/usart.h"
#include "hil/source/cortex_m_child/usb_host.h"
#include "hil/source/emulator/serial_pace.h"

namespace kerfbench::cortex_m_child {

using Usarts = std::vector<std::unique_ptr<Usart>>;

/// The line between the bench and the controller: its USB device from when that shows itself, and else one
/// USART, the lowest that receives, or that transmits where none receives. Bytes of the bench for a USART
/// follow each other at its baud rate, 8N1, and wait only for RTS.
class SerialLine {
 public:
  SerialLine(Present& present, const CoreTime& time, const Usarts& usarts, UsbDevice& usb,
             std::uint32_t baud);

  void send(std::span<const std::uint8_t> bytes, std::uint64_t watermark_tick);
  /// Tick at which a frame of the bench begins or ends next, or the USB host does something.
  [[nodiscard]] std::uint64_t nextTick();
  /// Does what is due at nextTick().
  void run();
  /// A USART begins a frame.
  void onTransmit(const Usart& usart, std::uint8_t byte, Cycle end);
  /// Bytes of the firmware whose frames have ended.
  std::vector<std::uint8_t> takeSent(std::uint64_t until_tick);

 private:
  struct SentByte {
    std::uint64_t done_at{};
    std::uint8_t byte{};
  };
  [[nodiscard]] Usart* receiver() const;
  [[nodiscard]] bool isOnUsb() const;
  [[nodiscard]] std::uint64_t nextFrameTick() const;
  void runUsart();
  void checkUsb();
  void watch(const Usart& usart);

  Present& present_;
  const CoreTime& time_;
  const Usarts& usarts_;
  std::uint32_t baud_;
  std::deque<std::uint8_t> to_send_;
  UsbHost usb_host_;
  std::deque<SentByte> sent_;
  bool in_frame_{};
  std::uint64_t free_at_{};  ///< Tick at which the last frame ended, or this one ends.
  emulator::SerialPace pace_;
};

}  // namespace kerfbench::cortex_m_child
