// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/usb_descriptors.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint8_t kInterface = 4, kEndpoint = 5, kClassInterface = 0x24, kUnion = 6;
constexpr std::uint8_t kCommunication = 0x02, kAbstractControl = 0x02, kData = 0x0A;
constexpr std::uint8_t kBulk = 2, kInterrupt = 3, kToHost = 0x80;
constexpr std::size_t kConfigurationValueAt = 5;

/// An interface in its first setting.
struct Interface {
  std::uint8_t number{}, code{}, subclass{};
  std::optional<std::uint8_t> data_interface;  ///< What a union says.
  std::optional<UsbEndpoint> bulk_in, bulk_out, interrupt_in;
};

void addEndpoint(Interface& interface, std::span<const std::uint8_t> from) {
  const UsbEndpoint endpoint{static_cast<std::uint8_t>(from[2] & 0xFU),
                             static_cast<std::uint16_t>((from[4] | from[5] << 8) & 0x7FF),
                             std::max<std::uint8_t>(1, from[6])};
  const bool is_in = (from[2] & kToHost) != 0;
  const std::uint8_t kind = from[3] & 3U;
  if (kind == kBulk) (is_in ? interface.bulk_in : interface.bulk_out) = endpoint;
  if (kind == kInterrupt && is_in) interface.interrupt_in = endpoint;
}

/// Interfaces of a configuration; nothing where lengths do not add up.
std::optional<std::vector<Interface>> interfacesOf(std::span<const std::uint8_t> bytes) {
  std::vector<Interface> interfaces;
  bool is_first_setting = false;
  while (!bytes.empty()) {
    const std::size_t length = bytes[0];
    if (length < 2 || length > bytes.size()) return std::nullopt;
    const auto descriptor = bytes.first(length);
    bytes = bytes.subspan(length);
    const std::uint8_t kind = descriptor[1];
    if (kind == kInterface && length >= 9) {
      is_first_setting = descriptor[3] == 0;
      if (is_first_setting)
        interfaces.push_back({descriptor[2], descriptor[5], descriptor[6], {}, {}, {}, {}});
    } else if (is_first_setting && kind == kEndpoint && length >= 7) {
      addEndpoint(interfaces.back(), descriptor);
    } else if (is_first_setting && kind == kClassInterface && length >= 5 && descriptor[2] == kUnion) {
      interfaces.back().data_interface = descriptor[4];
    }
  }
  return interfaces;
}

std::string classesOf(const std::vector<Interface>& interfaces) {
  std::string text;
  for (const Interface& interface : interfaces) {
    char code[8] = "";
    std::snprintf(code, sizeof code, "%s%02x", text.empty() ? "" : ", ", interface.code);
    text += code;
  }
  return text;
}

bool isData(const Interface& interface) {
  return interface.code == kData && interface.bulk_in && interface.bulk_out &&
         interface.bulk_in->most_bytes > 0 && interface.bulk_out->most_bytes > 0;
}

}  // namespace

std::optional<CdcLine> findCdcLine(std::span<const std::uint8_t> configuration, std::string& words) {
  const auto interfaces = interfacesOf(configuration);
  if (!interfaces || configuration.size() <= kConfigurationValueAt) {
    words = "has a configuration whose descriptors' lengths do not add up";
    return std::nullopt;
  }
  const auto control = std::ranges::find_if(*interfaces, [](const Interface& interface) {
    return interface.code == kCommunication && interface.subclass == kAbstractControl;
  });
  if (control == interfaces->end()) {
    words = "has no serial line (CDC-ACM): its interfaces are of class " + classesOf(*interfaces);
    return std::nullopt;
  }
  const auto data = std::ranges::find_if(*interfaces, [&](const Interface& interface) {
    return isData(interface) && interface.number == control->data_interface.value_or(interface.number);
  });
  if (data == interfaces->end()) {
    words = "has a serial line (CDC-ACM) without a data interface of class 0a with a bulk endpoint each way";
    return std::nullopt;
  }
  return CdcLine{configuration[kConfigurationValueAt], control->number, control->interrupt_in,
                 *data->bulk_out, *data->bulk_in};
}

}  // namespace kerfbench::cortex_m_child
