// SPDX-License-Identifier: Apache-2.0
#include "hil/base/file_content.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

std::optional<std::string> fileContent(const std::filesystem::path& path) {
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd.valid()) return std::nullopt;
  std::string content;
  std::array<char, 1U << 16U> bytes{};
  for (;;) {
    const ssize_t got = ::read(fd.get(), bytes.data(), bytes.size());
    if (got == 0) return content;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    content.append(bytes.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace kerfbench::base
