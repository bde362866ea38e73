// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kerfbench::base {

/// All bytes of a record of the bench, as openInput() opens it: a regular file of at most 64 MiB. Nothing
/// where it cannot be read, with the reason in errno.
std::optional<std::string> fileContent(const std::filesystem::path& path);

}  // namespace kerfbench::base
