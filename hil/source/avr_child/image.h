// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::avr_child {

/// Content of the controller's memories. Bytes that the image does not set are 0xFF, as after an erase.
struct Image {
  std::vector<std::uint8_t> flash;
  std::vector<std::uint8_t> eeprom;  ///< Empty if the image has none.
};

/// Reads Intel HEX, or ELF by its magic. Everything is checked: an image that a programmer would refuse is
/// refused.
/// @throws std::runtime_error with the file and the line.
Image readImage(const std::string& path, std::size_t flash_size, std::size_t eeprom_size);

/// Reads what an EEPROM holds: Intel HEX from address 0, as avr-objcopy and programmers write it, or with the
/// linker's addresses; anything else is taken byte by byte. Bytes beyond are 0xFF.
/// @throws std::runtime_error with the file and the line.
std::vector<std::uint8_t> readEeprom(const std::string& path, std::size_t eeprom_size);

}  // namespace kerfbench::avr_child
