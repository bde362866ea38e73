// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::guest {

/// Ends the program with what CTest takes for a skipped test where there is no QEMU.
void skipWithoutQemu();
/// Runs a guest by its command line; whether all went well in it.
bool runGuest(const std::string& command);

}  // namespace kerfbench::guest
