// SPDX-License-Identifier: Apache-2.0
#include "hil/base/shell_word.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "hil/base/utf8.h"

namespace kerfbench::base {
namespace {

/// What a shell takes a word for: its argument, and a mark behind it.
std::string asTaken(const std::string& word, const char* shell) {
  // Handed over by an environment variable, so that nothing but the word itself is quoted here.
  const std::string script = "set -- " + shellWord(word) + "; printf '%s|%s' \"$#\" \"$1\"";
  setenv("KB_SCRIPT", script.c_str(), 1);
  std::FILE* pipe = popen(fmt::format("{} -c \"$KB_SCRIPT\"", shell).c_str(), "r");
  std::string got;
  std::array<char, 4096> bytes{};
  for (std::size_t n = 0; (n = std::fread(bytes.data(), 1, bytes.size(), pipe)) > 0;)
    got.append(bytes.data(), n);
  pclose(pipe);
  return got;
}

TEST(ShellWord, IsTheSameWordForAShell) {
  const std::vector<std::string> words{"plain-1.yaml",
                                       "",
                                       "it's $(touch PWN).yaml",
                                       "`touch PWN`",
                                       "a b",
                                       "a\\b",
                                       "'",
                                       "''\"\"",
                                       "#comment",
                                       "~root",
                                       "{a,b}",
                                       "[a]*?",
                                       "a;b|c&d>e<f",
                                       "!!",
                                       "$HOME",
                                       "a=b c",
                                       "-n",
                                       "50%d%%s",
                                       "Größe",
                                       "a\nb",
                                       "\x1b[31m\x07\x03",
                                       "tab\there",
                                       "C1 \xc2\x9b and \xff",
                                       "\x1b\\0101 100%s '$(touch PWN)'"};
  for (const char* shell : {"sh", "bash"}) {
    for (const std::string& word : words) EXPECT_EQ(asTaken(word, shell), "1|" + word) << shellWord(word);
  }
}

TEST(ShellWord, LeavesPlainWordsAsTheyAre) {
  for (const char* word : {"run", "--seed=1", "fixtures/scenarios/label-on-belt.yaml", "1:2,3@x%y+z"})
    EXPECT_EQ(shellWord(word), word);
}

TEST(ShellWord, HasNothingThatATerminalObeysWhenItIsPasted) {
  for (const char* word : {"a\nb", "a\n", "\x1b[31m", "\x03", "\xc2\x9b"})
    EXPECT_FALSE(hasControl(shellWord(word))) << shellWord(word);
}

}  // namespace
}  // namespace kerfbench::base
