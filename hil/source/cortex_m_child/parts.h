// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerfbench::cortex_m_child {

/// A part of the STM32F103 family (data sheets DS5319 and DS5792 of STMicroelectronics): its memories,
/// and those of its devices that are modelled.
struct Part {
  std::string_view names;  ///< Blanks between them.
  std::uint32_t flash_bytes{};
  std::uint32_t sram_bytes{};
  std::uint32_t page_bytes{};  ///< What one erase of the flash clears.
  std::string_view ports;      ///< Letters of the ports that the package has pins of.
  std::string_view timers;     ///< Digits.
  std::string_view usarts;     ///< Digits.
  std::uint32_t device_id{};   ///< Low half of DBGMCU_IDCODE.
};

/// Null where no part has this name.
const Part* partNamed(std::string_view name);

/// The part of this name, or all of them where none is called so, in the words of DESCRIPTION in
/// pin_stream.h. Ports have 16 bits each; none of the parts has an EEPROM.
std::string describeParts(const std::string& name);

}  // namespace kerfbench::cortex_m_child
