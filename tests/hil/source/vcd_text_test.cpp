// SPDX-License-Identifier: Apache-2.0
#include "hil/source/vcd_text.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/hil/source/vcd_sample.h"

namespace kerfbench::source {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class VcdTextTest : public VcdTest {};

/// All that is read of a text, with lines, sections and digests.
std::string readOf(const std::filesystem::path& path, std::size_t piece) {
  VcdText text(path, {}, piece);
  std::string all;
  for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
    if (word != "$comment") {
      all += std::to_string(text.line()) + ":" + std::string(word) + " ";
      continue;
    }
    const auto section = text.section(word);
    if (!section) return all + "cut";
    for (const std::string_view one : section->words) all += "[" + std::string(one) + "]";
    all += std::to_string(text.line()) + "{" + std::string(section->text) + "}" +
           std::string(section->whole) + "/" + text.digestBefore(section->whole.data()).substr(0, 8) + " ";
  }
  return all;
}

TEST_F(VcdTextTest, IsTheSameInPiecesOfAnySize) {
  const std::string content =
      "  $comment a  bc\td\n ef $end\n\n#12\n1!\nlonger-than-some-pieces\n$comment $end\r\n0\"  ";
  const auto path = put("pieces.vcd", content);
  const std::string whole = readOf(path, content.size());
  EXPECT_EQ(whole, "[a][bc][d][ef]2{a  bc\td\n ef}$comment a  bc\td\n ef $end/" +
                       base::sha256(content.substr(0, 2)).substr(0, 8) +
                       " 4:#12 5:1! 6:longer-than-some-pieces 7{}$comment $end/" +
                       base::sha256(content.substr(0, content.find("$comment $end"))).substr(0, 8) +
                       " 8:0\" ");
  for (std::size_t piece = 1; piece < content.size(); ++piece) EXPECT_EQ(readOf(path, piece), whole) << piece;
  for (std::size_t piece = 1; piece < 9; ++piece) {
    EXPECT_EQ(readOf(put("cut.vcd", "#1 $comment a bc"), piece), "1:#1 cut");
    EXPECT_EQ(readOf(put("empty.vcd", ""), piece), "");
  }
}

TEST_F(VcdTextTest, KnowsWhetherOnlyBlanksFollow) {
  for (std::size_t piece = 1; piece < 9; ++piece) {
    VcdText blank(put("blank.vcd", "a \n\n  \n"), {}, piece);
    EXPECT_EQ(blank.word(), "a");
    EXPECT_TRUE(blank.onlyBlanksFollow());
    VcdText more(put("more.vcd", "a \n\t"), {}, piece);
    EXPECT_EQ(more.word(), "a");
    EXPECT_FALSE(more.onlyBlanksFollow());
  }
}

TEST_F(VcdTextTest, ASectionKeepsSixtyFourWords) {
  std::string content = "$comment";
  for (int i = 0; i < 70; ++i) content += " " + std::to_string(i);
  VcdText text(put("words.vcd", content + " $end"), {}, 16);
  const auto section = text.section(text.word());
  ASSERT_TRUE(section);
  EXPECT_EQ(section->words.size(), 64U);
  EXPECT_TRUE(section->text.ends_with(" 68 69"));
}

TEST_F(VcdTextTest, AWordWithoutEndIsRefused) {
  const auto path = roomyFolder() / "kerfbench-endless.vcd";
  std::ofstream(path) << "$timescale 1 ns " + std::string(VcdText::kMostKept + VcdText::kPiece * 2, 'x');
  try {
    (void)readVcd(path, sampleMap());
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(), (path.string() + ":1: a word or a section of more than 64 MiB").c_str());
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace kerfbench::source
