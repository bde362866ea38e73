// SPDX-License-Identifier: Apache-2.0
#include "hil/base/text.h"

#include <string>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

TEST(Trimmed, HasNoBlanksAtItsEnds) {
  EXPECT_EQ(trimmed(" \t\r\n\f\va b\r\n"), "a b");
  EXPECT_EQ(trimmed("a"), "a");
  EXPECT_EQ(trimmed(" \t "), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Hundredths, OfNoughtHaveNoSign) {
  EXPECT_EQ(hundredths(-0.004), "0.00");
  EXPECT_EQ(hundredths(-0.006), "-0.01");
  EXPECT_EQ(hundredths(12.345678), "12.35");
}

TEST(Lowered, LeavesOtherScriptsAlone) { EXPECT_EQ(lowered("CuT-9 Ä"), "cut-9 Ä"); }

TEST(Printable, KeepsTextInAnyScript) { EXPECT_EQ(printable("Rille ä 折 🂡"), "Rille ä 折 🂡"); }

TEST(Printable, HoldsNothingThatATerminalObeys) {
  EXPECT_EQ(printable("\x1b[31mred\x7f\n"), "?[31mred??");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "?31m");  // U+009B begins a control sequence as ESC [ does.
}

TEST(Printable, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(printable("\x9b\xff"), "??");
  EXPECT_EQ(printable("\xc0\x80"), "??");            // Overlong.
  EXPECT_EQ(printable("\xe0\x80\x80"), "???");       // Overlong.
  EXPECT_EQ(printable("\xed\xa0\x80"), "???");       // A surrogate.
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "????");  // Beyond U+10FFFF.
  EXPECT_EQ(printable("\xe6\x8a"), "??");            // Cut off.
}

TEST(Printable, IsShortAndEndsAtACharacter) {
  EXPECT_EQ(printable("abcd", 4), "abcd");
  EXPECT_EQ(printable("abcde", 4), "abcd…");
  EXPECT_EQ(printable("abcä", 4), "abc…");
  EXPECT_EQ(inQuotes(std::string(41, 'x')), "'" + std::string(40, 'x') + "…'");
}

TEST(EscapeHtml, LeavesNothingThatEndsATextOrAnAttribute) {
  EXPECT_EQ(escapeHtml("<a href=\"x\">'&'</a> ä"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt; ä");
}

}  // namespace
}  // namespace kerfbench::base
