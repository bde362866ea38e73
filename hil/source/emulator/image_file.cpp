// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/image_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace kerfbench::emulator {

std::string imageContent(const std::string& path) {
  constexpr std::size_t kMaxFileBytes = 16U << 20U;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": " + std::strerror(errno));
  std::string bytes;
  char block[65536];
  while (file.read(block, sizeof block) || file.gcount() > 0) {
    bytes.append(block, static_cast<std::size_t>(file.gcount()));
    if (bytes.size() > kMaxFileBytes) throw std::runtime_error(path + ": larger than any image of firmware");
  }
  if (file.bad()) throw std::runtime_error(path + ": " + std::strerror(errno));
  return bytes;
}

void refuseImage(const std::string& path, const std::string& where, const std::string& what) {
  throw std::runtime_error(path + where + ": " + what);
}

}  // namespace kerfbench::emulator
