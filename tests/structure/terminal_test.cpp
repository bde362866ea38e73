// SPDX-License-Identifier: Apache-2.0
// What the programs say has names, texts and words of files that anybody may have written. It goes through
// one function, which leaves nothing that a terminal or a CI server would obey (hil/base/terminal.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <regex>
#include <string>
#include <string_view>

#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

/// Emulators speak to the bench, not to a terminal: their standard error is a pipe, and what comes out of it
/// is made printable. A file that a user asked for may go to standard output, byte for byte.
constexpr std::array<std::string_view, 7> kOthers{"hil/base/terminal.cpp",
                                                  "hil/source/avr_child/",
                                                  "hil/source/cortex_m_child/",
                                                  "hil/source/mcs51_child/",
                                                  "hil/source/emulator/",
                                                  "hil/source/analyser/sigrok_child/",
                                                  "firmware_under_test/planner/kerfplan/output_text.h"};

bool isOther(const std::string& name) {
  for (const std::string_view other : kOthers)
    if (name.starts_with(other)) return true;
  return false;
}

TEST(Terminal, IsWrittenToByOneFunction) {
  const std::regex writes(
      R"(\bf?puts\(|std::(cout|cerr|clog)\b|fmt::print\(|\bprintf\(|\bv?fprintf\(|\bperror\()");
  std::size_t looked_at = 0;
  for (const char* top : {"hil", "twin", "firmware_under_test/planner"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      const std::string name = fs::relative(entry.path(), sourceRoot()).generic_string();
      ++looked_at;
      if (isOther(name)) continue;
      const std::string text = textOf(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), writes); it != std::sregex_iterator(); ++it) {
        const auto line = 1 + std::count(text.begin(), text.begin() + it->position(), '\n');
        ADD_FAILURE() << name << ":" << line << ": " << it->str() << " … in place of base::toTerminal()";
      }
    }
  }
  EXPECT_GT(looked_at, 500U);
}

}  // namespace
}  // namespace kerfbench::test
