// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::guest {

/// Ends the program with the code of a skipped test where there is no QEMU.
void skipWithoutQemu();
/// Runs a guest by its command line; true if all went well in it.
bool runGuest(const std::string& command);

}  // namespace kerfbench::guest
