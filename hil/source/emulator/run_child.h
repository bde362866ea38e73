// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "hil/source/emulator/emulator.h"

namespace kerfbench::emulator {

/// Makes the emulator with the image loaded. @throws std::exception if it cannot; its words go to the bench.
using Opener = std::function<std::unique_ptr<Emulator>(const OpenRequest&)>;
/// Answers DESCRIBE: the controller of a name, or all where none is called so, one a line. Fields with tabs
/// between them: names with blanks between them; bytes of flash, of SRAM, of EEPROM; letters of its ports;
/// digits of its timers; of its UARTs.
using Describer = std::function<std::string(const std::string& name)>;

/// The main function of a child: serves the requests on file descriptor 0 until QUIT, with replies on 1.
/// What a library prints to standard output goes to standard error. The image is not trusted: no privileges
/// are gained, at most so much address space is taken, and once it is loaded the process is confined
/// (sandbox.h).
/// @param program name of the program in messages. @param address_space_bytes 1 GiB; more for a library that
/// sets more aside than it uses. @return exit code of the program.
int runChild(std::string_view program, const Opener& open, const Describer& describe,
             std::uint64_t address_space_bytes = std::uint64_t{1} << 30U);

}  // namespace kerfbench::emulator
