// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/standard_input.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <optional>
#include <system_error>
#include <utility>

#include "hil/base/atomic_file.h"
#include "hil/base/input_error.h"
#include "hil/base/input_file.h"

namespace kerfbench::cli {
namespace {

namespace fs = std::filesystem;

std::string nothingHasCome() { return fmt::format("{}: nothing has come", kStandardInputName); }

constexpr const char* kFolderPrefix = "kerfbench-input";
constexpr const char* kFileStem = "standard-input";

}  // namespace

std::string standardInputText() {
  base::InputContent input = base::readStandardInput(base::kLargestRecord_bytes);
  if (!input.bytes) throw base::InputError(fmt::format("{}: {}", kStandardInputName, input.refusal));
  if (input.bytes->empty()) throw base::InputError(nothingHasCome());
  return *std::move(input.bytes);
}

std::string textOfInput(const fs::path& file) {
  return isStandardInput(file) ? standardInputText() : base::inputContent(file, base::kLargestRecord_bytes);
}

std::string extensionByContent(std::string_view text) {
  if (text.starts_with("%PDF-")) return ".pdf";
  if (text.starts_with("$BOF")) return ".cf2";
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with("<")) return ".svg";
  // A DXF is pairs of lines, a number and a value: 0 SECTION, or first 999 and a remark.
  const std::string_view line = text.substr(0, text.find_first_of(" \t\r\n"));
  return line == "0" || line == "999" ? ".dxf" : ".yaml";
}

InputAsFile::InputAsFile() : folder_(fs::temp_directory_path(), kFolderPrefix) {
  std::array<char, 1U << 16U> bytes{};
  std::optional<base::AtomicFile> file;
  for (;;) {
    const ssize_t got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::system_error(errno, std::generic_category(), kStandardInputName);
    if (got == 0) break;
    const std::string_view piece(bytes.data(), static_cast<std::size_t>(got));
    if (!file) {
      path_ = folder_.path() / (std::string(kFileStem) + (piece.starts_with("PK") ? ".sr" : ".vcd"));
      file.emplace(path_);
    }
    file->write(piece);
  }
  if (!file) throw base::InputError(nothingHasCome());
  file->commit();
}

InputAsFile::InputAsFile(std::string_view text, const std::string& extension)
    : folder_(fs::temp_directory_path(), kFolderPrefix), path_(folder_.path() / (kFileStem + extension)) {
  base::writeFileAtomically(path_, text);
}

std::string withInputNamed(std::string sentence, const fs::path& file) {
  for (std::size_t at = sentence.find(file.string()); at != std::string::npos;
       at = sentence.find(file.string(), at))
    sentence.replace(at, file.string().size(), kStandardInputName);
  return sentence;
}

}  // namespace kerfbench::cli
