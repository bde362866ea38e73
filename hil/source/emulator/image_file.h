// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace kerfbench::emulator {

/// Takes bytes of an image. `where` names their place in the file for messages (":12", ": segment 1").
/// @throws std::runtime_error if the controller has no memory there.
using Placer =
    std::function<void(std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string& where)>;

/// The whole file, of at most 16 MiB. @throws std::runtime_error with the path.
std::string imageContent(const std::string& path);

/// Ends the reading of an image: @throws std::runtime_error "path" + "where" + ": what".
[[noreturn]] void refuseImage(const std::string& path, const std::string& where, const std::string& what);

}  // namespace kerfbench::emulator
