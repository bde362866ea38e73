// SPDX-License-Identifier: Apache-2.0
// "The way of a pulse" in ARCHITECTURE.md names real files, and the functions beside them are defined there.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

struct Hop {
  std::string name;
  std::string file;
  std::string function;
};

/// The rows "| hop | `file` | `function` | … |" between this heading and the next.
std::vector<Hop> hopsOf(const std::string& text) {
  static const std::regex kRow(R"re(^\| ([^|`]+) \| `([^`|]+)` \| `([^`|]+)` \| [^|]+ \|$)re");
  const std::size_t from = text.find("## The way of a pulse");
  if (from == std::string::npos) return {};
  std::istringstream lines(text.substr(from, text.find("\n## ", from) - from));
  std::vector<Hop> hops;
  std::smatch row;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, row, kRow)) hops.push_back({row[1], row[2], row[3]});
  }
  return hops;
}

/// Rows of the table by their first character alone, headings and rule included.
std::size_t rowsOf(const std::string& text) {
  const std::size_t from = text.find("## The way of a pulse");
  if (from == std::string::npos) return 0;
  std::istringstream lines(text.substr(from, text.find("\n## ", from) - from));
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line);) rows += line.starts_with("|") ? 1 : 0;
  return rows;
}

/// True where the name is followed by an argument list, or is in one as the name of an interrupt is.
bool holdsFunction(const std::string& source, const std::string& function) {
  for (std::size_t at = source.find(function); at != std::string::npos; at = source.find(function, at + 1)) {
    const char before = at > 0 ? source[at - 1] : ' ';
    const char after = at + function.size() < source.size() ? source[at + function.size()] : ' ';
    if (!isWordCharacter(before) && (after == '(' || (before == '(' && after == ')'))) return true;
  }
  return false;
}

TEST(PulseTable, NamesFilesThatHoldTheFunctionBesideThem) {
  const std::string page = textOf(sourceRoot() / "ARCHITECTURE.md");
  const std::vector<Hop> hops = hopsOf(page);
  EXPECT_GT(hops.size(), 30U);
  // Two rows are heading and rule; every other row was understood.
  EXPECT_EQ(rowsOf(page), hops.size() + 2);
  for (const Hop& hop : hops) {
    const auto path = sourceRoot() / hop.file;
    ASSERT_TRUE(std::filesystem::is_regular_file(path)) << hop.name << ": there is no " << hop.file;
    EXPECT_TRUE(holdsFunction(textOf(path), hop.function))
        << hop.name << ": " << hop.file << " has no " << hop.function;
  }
}

TEST(PulseTable, AFunctionOfAnotherNameIsNotTheOneThatIsLookedFor) {
  EXPECT_TRUE(holdsFunction("Stop advance(Tick until)", "advance"));
  EXPECT_TRUE(holdsFunction("ISR(TIMER1_COMPA_vect) {", "TIMER1_COMPA_vect"));
  EXPECT_FALSE(holdsFunction("// kb_frame_byte takes it", "kb_frame_byte"));
  EXPECT_FALSE(holdsFunction("void unadvance(int);", "advance"));
}

}  // namespace
}  // namespace kerfbench::test
