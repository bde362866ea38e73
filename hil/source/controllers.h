// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "twin/base/pin_event.h"

namespace kerfbench::source {

/// A controller that an emulator has.
struct Controller {
  std::vector<std::string> names;  ///< Names of what is one and the same to the emulator.
  std::size_t flash_bytes{}, sram_bytes{}, eeprom_bytes{};
  std::string ports;      ///< Letters, "BCD", or the digits of an 8051, "0123".
  std::string timers;     ///< Digits, "012".
  std::string uarts;      ///< Digits; the bench talks to the first.
  unsigned port_bits{8};  ///< Bits of each port.

  [[nodiscard]] bool isCalled(std::string_view name) const;
  /// Whether it has the port; which of its eight bits are led out the emulator does not know.
  [[nodiscard]] bool hasPin(PinId pin) const;
  /// "PD2", or "P1.2" where ports have numbers.
  [[nodiscard]] std::string nameOf(PinId pin) const;
};

/// Asks the emulator `child`, one of the bench's own, for the controller of a name, or for all that it has
/// where none is called so. @throws std::runtime_error if it does not say.
std::vector<Controller> emulatedControllers(const std::filesystem::path& child, const std::string& mcu);

/// The names that are most like this one, which is none of them: up to three, the nearest first, by how many
/// letters must be changed, added or left out (Levenshtein 1966).
std::vector<std::string> namesLike(std::string_view name, const std::vector<Controller>& controllers);

}  // namespace kerfbench::source
