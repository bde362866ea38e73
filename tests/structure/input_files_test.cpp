// SPDX-License-Identifier: Apache-2.0
// Every file of a user is opened by hil/base/input_file.h, which takes regular files alone and none that is
// larger than its reader takes. What opens a file by itself stands in the list below, with the reason.
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 13> kOpeners{
    "ifstream", "fopen",    "freopen", "imread",  "LoadFile", "LoadAllFromFile", "zip_open",
    "filebuf",  "O_RDONLY", "O_RDWR",  "openat2", "fstream",  "FileStorage"};

/// Files that may open by themselves, and what of the above they may use.
const std::map<std::string, std::set<std::string_view>>& known() {
  static const std::map<std::string, std::set<std::string_view>> kKnown{
      {"hil/base/input_file.cpp", {"O_RDONLY"}},
      // A program of its own, under the licence of an emulator: it opens its one file by the same rules.
      {"hil/source/emulator/image_file.cpp", {"O_RDONLY"}},
      // Devices, opened by the systems that tests take the place of.
      {"hil/source/gpio/system.cpp", {"O_RDWR"}},
      {"hil/source/serial/serial_system.cpp", {"O_RDWR"}},
      {"hil/camera/v4l2/video_calls.cpp", {"O_RDWR"}},
      // /dev/null as the standard input of a child.
      {"hil/source/confinement.cpp", {"O_RDONLY"}},
      {"hil/scene/povray.cpp", {"O_RDONLY"}},
      {"hil/witness/bounded_run.cpp", {"O_RDONLY"}},
      {"hil/source/emulator/run_child.cpp", {"O_RDONLY"}},
      {"hil/batch/job_process.cpp", {"O_RDONLY"}},
      // Folders, and the temporary files, locks and archives that the bench writes.
      {"hil/base/atomic_file.cpp", {"O_RDONLY"}},
      {"hil/base/temporary.cpp", {"O_RDONLY"}},
      {"hil/base/spill_file.cpp", {"O_RDWR"}},
      {"hil/batch/folder_lock.cpp", {"O_RDWR"}},
      {"hil/scene/film_writer.cpp", {"O_RDONLY"}},
      {"hil/camera/v4l2/frame_recording.cpp", {"O_RDONLY"}},
      {"hil/source/analyser/zip_archive.cpp", {"zip_open"}},
      // Files that the window hands out unread: beneath its folder, its own pages, the trace of its own run.
      {"hil/serve/work_folder.cpp", {"O_RDONLY"}},
      {"hil/serve/window.cpp", {"O_RDONLY"}},
      {"hil/serve/file_body.cpp", {"O_RDONLY"}},
      {"hil/serve/runs.cpp", {"O_RDONLY"}},
  };
  return kKnown;
}

/// A source without its includes and comments at the end of lines; a line of a comment alone is left out.
std::string codeOf(const fs::path& path) {
  const std::string text = textOf(path);
  std::string code;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    std::string_view line = std::string_view(text).substr(from, to - from);
    from = to + 1;
    line = line.substr(0, line.find("//"));
    if (!line.starts_with("#include")) code.append(line).append("\n");
  }
  return code;
}

bool hasWord(const std::string& code, std::string_view word) {
  for (std::size_t at = code.find(word); at != std::string::npos; at = code.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool begins = at == 0 || !isWordCharacter(code[at - 1]);
    const bool ends = end == code.size() || !isWordCharacter(code[end]);
    if (begins && ends) return true;
  }
  return false;
}

/// What a source opens files by.
std::set<std::string_view> openersIn(const fs::path& path) {
  const std::string code = codeOf(path);
  std::set<std::string_view> found;
  for (const std::string_view word : kOpeners) {
    if (hasWord(code, word)) found.insert(word);
  }
  return found;
}

TEST(InputFiles, AreOpenedInOnePlace) {
  std::map<std::string, std::set<std::string_view>> opening;
  for (const char* top : {"hil", "firmware_under_test", "twin"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const auto extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".h" && extension != ".c") continue;
      if (auto found = openersIn(entry.path()); !found.empty())
        opening.emplace(fs::relative(entry.path(), sourceRoot()).string(), std::move(found));
    }
  }
  EXPECT_EQ(opening, known()) << "a file of a user is opened by hil/base/input_file.h";
}

TEST(InputFiles, OpenersAreFoundAsWords) {
  EXPECT_TRUE(hasWord("  std::ifstream file(path);", "ifstream"));
  EXPECT_TRUE(hasWord("YAML::LoadFile(path)", "LoadFile"));
  EXPECT_FALSE(hasWord("zip_fopen(archive)", "fopen"));
  EXPECT_FALSE(hasWord("std::ofstream file", "fstream"));
}

}  // namespace
}  // namespace kerfbench::test
