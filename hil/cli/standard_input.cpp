// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/standard_input.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <functional>
#include <optional>
#include <system_error>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/unique_fd.h"

namespace kerfbench::cli {
namespace {

namespace fs = std::filesystem;

/// Hands all that comes on standard input over, piece by piece.
void takeStandardInput(const std::function<void(std::string_view)>& take) {
  std::array<char, 1U << 16U> bytes{};
  std::size_t whole = 0;
  for (;;) {
    const ssize_t got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::system_error(errno, std::generic_category(), kStandardInputName);
    if (got == 0) break;
    whole += static_cast<std::size_t>(got);
    take({bytes.data(), static_cast<std::size_t>(got)});
  }
  if (whole == 0) throw base::InputError(fmt::format("{}: nothing has come", kStandardInputName));
}

/// A new file that is written piece by piece.
class NewFile {
 public:
  explicit NewFile(const fs::path& path)
      : path_(path), fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) {
    if (!fd_.valid()) fail();
  }
  void add(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t put = ::write(fd_.get(), bytes.data(), bytes.size());
      if (put < 0 && errno == EINTR) continue;
      if (put < 0) fail();
      bytes.remove_prefix(static_cast<std::size_t>(put));
    }
  }

 private:
  [[noreturn]] void fail() const { throw std::system_error(errno, std::generic_category(), path_.string()); }

  fs::path path_;
  base::UniqueFd fd_;
};

constexpr const char* kFolderPrefix = "kerfbench-input";
constexpr const char* kFileStem = "standard-input";

}  // namespace

std::string standardInputText() {
  constexpr std::size_t kMost_bytes = std::size_t{64} << 20U;
  std::string text;
  takeStandardInput([&](std::string_view piece) {
    text += piece;
    if (text.size() > kMost_bytes)
      throw base::InputError(fmt::format("{}: more than 64 MiB", kStandardInputName));
  });
  return text;
}

std::string textOfInput(const fs::path& file) {
  if (isStandardInput(file)) return standardInputText();
  std::optional<std::string> text = base::fileContent(file);
  if (!text) throw base::InputError("cannot read " + file.string());
  return *std::move(text);
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
  std::optional<NewFile> file;
  takeStandardInput([&](std::string_view piece) {
    if (!file) {
      path_ = folder_.path() / (std::string(kFileStem) + (piece.starts_with("PK") ? ".sr" : ".vcd"));
      file.emplace(path_);
    }
    file->add(piece);
  });
}

InputAsFile::InputAsFile(std::string_view text, const std::string& extension)
    : folder_(fs::temp_directory_path(), kFolderPrefix), path_(folder_.path() / (kFileStem + extension)) {
  NewFile(path_).add(text);
}

std::string withInputNamed(std::string sentence, const fs::path& file) {
  for (std::size_t at = sentence.find(file.string()); at != std::string::npos;
       at = sentence.find(file.string(), at))
    sentence.replace(at, file.string().size(), kStandardInputName);
  return sentence;
}

}  // namespace kerfbench::cli
