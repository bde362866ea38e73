// SPDX-License-Identifier: Apache-2.0
#include "hil/base/file_content.h"

#include <cerrno>
#include <utility>

#include "hil/base/input_file.h"

namespace kerfbench::base {

std::optional<std::string> fileContent(const std::filesystem::path& path) {
  InputContent content = readInput(path, kLargestRecord_bytes);
  if (!content.bytes) errno = content.error != 0 ? content.error : EINVAL;
  return std::move(content.bytes);
}

}  // namespace kerfbench::base
