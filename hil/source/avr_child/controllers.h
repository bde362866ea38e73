// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace kerfbench::avr_child {

/// The controller of this name, or all that the emulator has where none that it can start is called so, one a
/// line: names with blanks between them, tab, bytes of flash, tab, of SRAM, tab, of EEPROM, tab, letters of
/// its ports, tab, digits of its timers, tab, of its UARTs.
std::string describeControllers(const std::string& name);

}  // namespace kerfbench::avr_child
