// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/exti.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/pins.h"
#include "hil/source/cortex_m_child/rcc.h"
#include "hil/source/cortex_m_child/usb_packet_memory.h"

namespace kerfbench::cortex_m_child {

enum class UsbToken { kSetup, kOut, kIn };
/// What a device says to a token, or to the packet behind it. An endpoint that can take or give a packet is
/// ready; one that has none, or a device with another address, does not answer.
enum class UsbAnswer { kNone, kNak, kStall, kReady };

/// Whom the host means.
struct UsbTarget {
  UsbToken token{};
  unsigned address{};
  unsigned endpoint{};  ///< 0 to 15, without the bit of the direction.
};

/// A data packet.
struct UsbPacket {
  bool is_data1{};
  std::vector<std::uint8_t> bytes;
};

/// The full-speed USB device of the STM32F103 (STMicroelectronics 2015 RM0008, chapter 23): control, bulk and
/// interrupt endpoints with one buffer each. Isochronous endpoints, double buffers and the resume that a
/// device signals end the run by name.
///
/// The host calls poll() as a token begins, then fetch() for a packet of the device; receive() or
/// acknowledge() as the packet, or the host's acknowledgement, has ended.
class UsbDevice final : public Device {
 public:
  /// What it needs of the machine around it.
  struct Surroundings {
    Present& present;
    Nvic& nvic;
    Exti& exti;
    Pins& pins;
    const Rcc& rcc;
    const CoreTime& time;
  };
  explicit UsbDevice(const Surroundings& around) : around_(around) {}

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;
  [[nodiscard]] UsbPacketMemory& packetMemory() { return memory_; }

  /// Whether the host sees a pull-up on D+: boards have it fixed, and the device must be out of its
  /// power-down and its forced reset.
  [[nodiscard]] bool isAttached() const;
  /// The host drives both data lines low.
  void beginBusReset();
  void endBusReset();
  /// A packet that starts a frame. @param number counts frames; the device keeps 11 bits.
  void startFrame(std::uint64_t number);
  [[nodiscard]] UsbAnswer poll(const UsbTarget& target) const;
  /// The packet that an endpoint which is ready sends. Ends the run where its buffer is outside the memory.
  [[nodiscard]] UsbPacket fetch(const UsbTarget& target);
  /// The host's packet for an endpoint that was ready as its token came.
  UsbAnswer receive(const UsbTarget& target, const UsbPacket& packet);
  /// The host has acknowledged what fetch() gave.
  void acknowledge(const UsbTarget& target);

 private:
  static constexpr unsigned kEndpoints = 8;
  static constexpr unsigned kNone = kEndpoints;

  [[nodiscard]] std::uint32_t status() const;
  void writeEndpoint(unsigned index, std::uint32_t value);
  void writeControl(std::uint32_t value);
  void resetProtocol();
  void checkClock();
  void wake();
  void restartSuspendTimer();
  void updateLines();
  [[nodiscard]] unsigned find(const UsbTarget& target) const;
  [[nodiscard]] std::uint32_t descriptor(unsigned index, unsigned field);
  bool holds(unsigned index, std::uint32_t address, std::size_t bytes);
  void note(unsigned index, const UsbTarget& target);

  Surroundings around_;
  UsbPacketMemory memory_;
  std::array<std::uint32_t, kEndpoints> endpoints_{};  ///< EPnR
  std::uint32_t control_{3};                           ///< CNTR
  std::uint32_t status_{};                             ///< ISTR without CTR, DIR and EP_ID.
  std::uint32_t frame_{};
  std::uint32_t address_{};  ///< DADDR
  std::uint32_t table_{};    ///< BTABLE
  bool in_bus_reset_{};
  unsigned frames_seen_{};    ///< In a row, up to 2: then the frame timer is locked.
  unsigned frames_missed_{};  ///< In a row, up to 3: then the bus is suspended.
  Cycle quiet_since_{};
};

}  // namespace kerfbench::cortex_m_child
