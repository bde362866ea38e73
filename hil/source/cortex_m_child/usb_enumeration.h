// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/usb_descriptors.h"

namespace kerfbench::cortex_m_child {

/// A control transfer that the host asks for (USB 2.0 2000, 9.3).
struct UsbRequest {
  std::uint8_t type{};
  std::uint8_t request{};
  std::uint16_t value{};
  std::uint16_t index{};
  std::uint16_t length{};
  std::vector<std::uint8_t> data;  ///< For the device, where the request has any.
  std::string name;                ///< For people.

  [[nodiscard]] bool isToHost() const { return (type >> 7 & 1U) != 0; }
  [[nodiscard]] std::vector<std::uint8_t> setupBytes() const;
};

/// CLEAR_FEATURE(ENDPOINT_HALT) for an endpoint address with the bit of its direction.
[[nodiscard]] UsbRequest clearHalt(unsigned endpoint_address);

/// What a host asks of a device until its serial line is open, request by request: descriptors, address,
/// configuration, and the line's rate and control lines (USB 2.0 2000, 9.4; USB PSTN 1.2 2007, 6.3).
class UsbEnumeration {
 public:
  /// @param baud rate that SET_LINE_CODING says, 8N1.
  explicit UsbEnumeration(std::uint32_t baud) : baud_(baud) {}

  /// The request that is due. Call it only while isUnderWay().
  [[nodiscard]] UsbRequest request() const;
  /// The device has answered: with these bytes, or with a STALL.
  void finish(std::span<const std::uint8_t> answer);
  void stall();
  [[nodiscard]] bool isUnderWay() const { return step_ != Step::kOpen && refusal_.empty(); }
  /// Why this device is no serial line, in whole words; empty while nothing is against it.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Whether the device works, and is something else than a serial line.
  [[nodiscard]] bool isOtherDevice() const { return is_other_; }
  /// The device's address from now on; 0 at first.
  [[nodiscard]] unsigned address() const { return step_ > Step::kAddress ? 1 : 0; }
  /// Bytes of a packet of the control endpoint: 8, 16, 32 or 64.
  [[nodiscard]] unsigned controlBytes() const { return control_bytes_; }
  [[nodiscard]] const CdcLine& line() const { return line_; }

 private:
  enum class Step {
    kDeviceHead,
    kAddress,
    kDevice,
    kConfigurationHead,
    kConfiguration,
    kLanguages,
    kProduct,
    kSetConfiguration,
    kLineCoding,
    kControlLines,
    kOpen
  };
  void next() { step_ = static_cast<Step>(static_cast<int>(step_) + 1); }
  void takeDeviceHead(std::span<const std::uint8_t> answer);
  void takeDevice(std::span<const std::uint8_t> answer);
  void takeConfigurationHead(std::span<const std::uint8_t> answer);
  void takeConfiguration(std::span<const std::uint8_t> answer);
  void refuse(const std::string& what) { refusal_ = "the firmware's USB device " + what; }

  std::uint32_t baud_;
  Step step_{Step::kDeviceHead};
  unsigned control_bytes_{8};
  std::uint8_t product_string_{};
  std::uint16_t language_{};
  std::uint16_t configuration_bytes_{};
  CdcLine line_;
  std::string refusal_;
  bool is_other_{};
};

}  // namespace kerfbench::cortex_m_child
