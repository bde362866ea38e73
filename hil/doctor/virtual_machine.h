// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace kerfbench::doctor {

/// Sign by which this computer shows that it is a virtual machine, whose times are no machine's; empty: none.
/// `root`: root of the file system.
std::string virtualMachineSign(const std::filesystem::path& root = "/");

}  // namespace kerfbench::doctor
