// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/file_format.h"

#include <unistd.h>

#include <array>
#include <string_view>

#include "hil/base/input_file.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {

std::optional<FileFormat> fileFormatOf(const std::filesystem::path& path) {
  const std::string extension = lowered(path.extension().string());
  if (extension == ".dxf") return FileFormat::kDxf;
  if (extension == ".svg") return FileFormat::kSvg;
  if (extension == ".cf2" || extension == ".cff" || extension == ".cff2") return FileFormat::kCf2;
  if (extension == ".pdf") return FileFormat::kPdf;
  std::array<char, 8> buffer{};
  const base::OpenedInput file = base::openInput(path, base::kAnySize);
  if (!file.fd.valid()) return std::nullopt;
  const ssize_t got = ::read(file.fd.get(), buffer.data(), buffer.size());
  const std::string_view head(buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  if (head.starts_with("%PDF-")) return FileFormat::kPdf;
  if (head.starts_with("$BOF")) return FileFormat::kCf2;
  return std::nullopt;
}

}  // namespace kerfbench::dieline
