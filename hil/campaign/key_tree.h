// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::campaign {

/// Whether a text is a key with its sections, "belt.speed_mm_s": names of letters, digits, '_' and '-' with
/// points between them.
bool isKeyPath(const std::string& text);

/// A key with its sections, and its value as text of YAML.
using KeyValue = std::pair<std::string, std::string>;

/// Lines of YAML that give these keys, section by section in the order of the alphabet. No key may hold
/// another.
std::string yamlOf(const std::vector<KeyValue>& keys);

/// The text at a key of a file, or of one that it extends; nothing where it is not given, or is no text.
/// @throws base::ConfigError if the file cannot be read.
std::optional<std::string> textAt(const std::filesystem::path& file, const std::string& key);

/// The file that a key of `file` names, absolute; nothing where the key is not given.
/// @throws base::ConfigError as above.
std::optional<std::filesystem::path> fileAt(const std::filesystem::path& file, const std::string& key);

}  // namespace kerfbench::campaign
