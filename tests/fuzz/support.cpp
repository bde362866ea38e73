// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

std::filesystem::path makeFolder() {
  const std::filesystem::path memory = "/dev/shm";
  std::error_code none;
  std::string pattern =
      (std::filesystem::is_directory(memory, none) ? memory : std::filesystem::temp_directory_path()) /
      "kerfbench-fuzz-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for files can be made");
  return pattern;
}

/// Goes with the process.
struct Folder {
  std::filesystem::path path = makeFolder();
  Folder() = default;
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code none;
    std::filesystem::remove_all(path, none);
  }
};

}  // namespace

std::filesystem::path asFile(std::string_view name, Bytes bytes) { return asFile(name, textIn(bytes)); }

std::filesystem::path asFile(std::string_view name, std::string_view text) {
  static const Folder kFolder;
  std::filesystem::path path = kFolder.path / name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
  return path;
}

std::string_view partOf(Bytes bytes, std::size_t number) {
  constexpr std::string_view kBetween = "%%%%\n";
  std::string_view rest = textIn(bytes);
  for (; number > 0; --number) {
    const std::size_t at = rest.find(kBetween);
    if (at == std::string_view::npos) return {};
    rest.remove_prefix(at + kBetween.size());
  }
  return rest.substr(0, rest.find(kBetween));
}

}  // namespace kerfbench::fuzz
