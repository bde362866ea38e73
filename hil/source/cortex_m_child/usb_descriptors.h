// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kerfbench::cortex_m_child {

/// An endpoint as a descriptor has it (USB 2.0 2000, table 9-13).
struct UsbEndpoint {
  std::uint8_t number{};            ///< 1 to 15.
  std::uint16_t most_bytes{};       ///< In one packet.
  std::uint8_t interval_frames{1};  ///< Frames between two looks at an interrupt endpoint.
};

/// Where the serial line of a device is (USB CDC 1.2 and PSTN 1.2, 2007 and 2010).
struct CdcLine {
  std::uint8_t configuration{};
  std::uint8_t control_interface{};
  std::optional<UsbEndpoint> notifications;
  UsbEndpoint to_device;
  UsbEndpoint to_host;
};

/// Finds the abstract control model (class 02, subclass 02) and its data interface (class 0A) in a
/// configuration with all of its interfaces.
/// @param words what is wrong, where nothing is returned; whole words for "the firmware's USB device …".
[[nodiscard]] std::optional<CdcLine> findCdcLine(std::span<const std::uint8_t> configuration,
                                                 std::string& words);

}  // namespace kerfbench::cortex_m_child
