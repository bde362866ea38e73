// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace kerfbench::test {

inline std::filesystem::path sourceRoot() { return KERFBENCH_SOURCE_DIR; }

/// Text of a file; empty where there is none.
inline std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// True for a character of an identifier of C or C++.
inline bool isWordCharacter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

}  // namespace kerfbench::test
