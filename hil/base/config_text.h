// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace kerfbench::base {

/// Text of a file of settings, for those who need it as well as what YamlReader::openText() makes of it: the
/// file is read once. @throws ConfigError as YamlReader::openFile().
std::string configText(const std::filesystem::path& path);

}  // namespace kerfbench::base
