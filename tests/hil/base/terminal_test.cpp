// SPDX-License-Identifier: Apache-2.0
#include "hil/base/terminal.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>

#include "hil/base/utf8.h"

namespace kerfbench::base {
namespace {

TEST(Terminal, ObeysNothingOfForeignText) {
  EXPECT_EQ(forTerminal("a\x1b[31mb\x07\rc"), "a?[31mb??c");
  EXPECT_EQ(forTerminal("C1: \xc2\x9b 2J, DEL: \x7f"), "C1: ? 2J, DEL: ?");
  EXPECT_EQ(forTerminal("a lone \x9b, half a letter \xc3"), "a lone ?, half a letter ?");
  EXPECT_EQ(forTerminal("Größe\t1 µm\n漢字\n"), "Größe\t1 µm\n漢字\n");
}

TEST(Terminal, CiServersObeyNothingOfForeignText) {
  EXPECT_EQ(forTerminal("::set-output name=a::b"), ": :set-output name=a::b");
  EXPECT_EQ(forTerminal("x\n \t::stop-commands::y"), "x\n \t: :stop-commands::y");
  EXPECT_EQ(forTerminal("x ##[add-mask]y ##vso[z] ##teamcity[u]"),
            "x # #[add-mask]y # #vso[z] # #teamcity[u]");
  EXPECT_EQ(forTerminal("###[x]"), "## #[x]");
  EXPECT_EQ(forTerminal("a::b ## c"), "a::b ## c");
}

TEST(Terminal, JsonStaysTheSameValue) {
  const nlohmann::json json{{"layer", "\x1b[31m \xc2\x9b 2J ##[add-mask] Größe \x7f 漢"}, {"n", 1.5}};
  const std::string shown = jsonForTerminal(json.dump());
  EXPECT_EQ(nlohmann::json::parse(shown), json);
  EXPECT_FALSE(hasControl(shown));
  EXPECT_EQ(shown.find("##["), std::string::npos);
  EXPECT_EQ(forTerminal(shown), shown);
}

TEST(Terminal, WritesWhatItSays) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  toTerminal(file, std::string("a\0b\x1b\n", 5));
  std::rewind(file);
  char got[16] = {};
  EXPECT_EQ(std::fread(got, 1, sizeof got, file), 5U);
  EXPECT_STREQ(got, "a?b?\n");
  std::fclose(file);
}

TEST(Utf8, MarkupTextIsWhatXmlCanHold) {
  EXPECT_EQ(markupText("a\x01 b\xff\n\tc\xef\xbf\xbe d"), "a\xef\xbf\xbd b\xef\xbf\xbd\n\tc\xef\xbf\xbd d");
  EXPECT_EQ(markupText("Größe µm 漢 😀"), "Größe µm 漢 😀");
  EXPECT_EQ(markupText("\xed\xa0\x80"), "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // Half of a pair of UTF-16.
}

TEST(Utf8, FindsControlCharacters) {
  EXPECT_TRUE(hasControl("a\nb"));
  EXPECT_TRUE(hasControl("\xc2\x85"));
  EXPECT_FALSE(hasControl("Größe \xc2\xa0"));
  EXPECT_FALSE(hasControl("not UTF-8: \xff\x9b"));
}

}  // namespace
}  // namespace kerfbench::base
