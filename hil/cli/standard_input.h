// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hil/base/temporary.h"

namespace kerfbench::cli {

/// What stands for standard input where a file is asked for.
inline constexpr std::string_view kFromStandardInput = "-";
/// How faults call it. Names of files in a text that came by it are relative to the current folder.
inline constexpr const char* kStandardInputName = "standard input";

inline bool isStandardInput(const std::filesystem::path& file) { return file == kFromStandardInput; }

/// All that comes on standard input. @throws base::InputError beyond 64 MiB, and where nothing comes.
std::string standardInputText();

/// Text of a file, or of standard input. @throws base::InputError if it cannot be read.
std::string textOfInput(const std::filesystem::path& file);

/// Extension of the format in which a text is, by how it begins: ".pdf", ".cf2", ".svg", ".dxf"; ".yaml" for
/// all else.
std::string extensionByContent(std::string_view text);

/// Bytes as a file, for a reader that needs one: "standard-input" and the extension, in a folder of this
/// process, which ends with this.
class InputAsFile {
 public:
  /// All that comes on standard input, however long. Its extension is that of a recording: ".sr" for a
  /// session file of sigrok, a ZIP archive, else ".vcd". @throws std::system_error, base::InputError.
  InputAsFile();
  /// A text that was read. @throws std::system_error.
  InputAsFile(std::string_view text, const std::string& extension);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  base::TemporaryFolder folder_;
  std::filesystem::path path_;
};

/// A sentence in which `file`, which holds standard input, is called by that name.
std::string withInputNamed(std::string sentence, const std::filesystem::path& file);

}  // namespace kerfbench::cli
