// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

namespace kerfbench::scene {

/// The path of a program that pictures or films are made with: a name is looked up in PATH. Nullopt: there is
/// none that may be run.
std::optional<std::filesystem::path> findProgram(const std::filesystem::path& program);

}  // namespace kerfbench::scene
