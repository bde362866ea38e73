// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/file_body.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::serve {
namespace {

const auto kReads = [] { return false; };

std::string contentOf(AnswerBody& body) {
  std::string text;
  while (const auto piece = body.next(kReads)) text += *piece;
  return text;
}

class RangeTest : public testing::Test {
 protected:
  Answer answerTo(const std::string& range) {
    HttpHead head;
    if (!range.empty()) head.headers["range"] = range;
    return fileAnswer(base::UniqueFd(::open(file_.c_str(), O_RDONLY | O_CLOEXEC)), "a.mcap", head);
  }
  base::TempFolder folder_;
  std::filesystem::path file_{folder_.write("a.mcap", "0123456789")};
};

TEST_F(RangeTest, OneRangeIsAnsweredWithItsBytes) {
  struct Case {
    const char *range, *content_range, *bytes;
  };
  for (const Case& each : {Case{"bytes=0-3", "bytes 0-3/10", "0123"}, Case{"bytes=4-4", "bytes 4-4/10", "4"},
                           Case{"bytes=7-", "bytes 7-9/10", "789"}, Case{"bytes=-2", "bytes 8-9/10", "89"},
                           Case{"bytes=5-99999999999999999", "bytes 5-9/10", "56789"},
                           Case{"bytes=-99", "bytes 0-9/10", "0123456789"}}) {
    Answer answer = answerTo(each.range);
    EXPECT_EQ(answer.status, 206) << each.range;
    EXPECT_EQ(contentOf(*answer.body), each.bytes) << each.range;
    EXPECT_EQ(answer.body_bytes, std::string(each.bytes).size());
    EXPECT_THAT(answer.headers, testing::Contains(testing::Pair("Content-Range", each.content_range)));
  }
}

TEST_F(RangeTest, BeyondTheEndThereIsNothing) {
  for (const char* range : {"bytes=10-", "bytes=10-12", "bytes=-0", "bytes=99999999999999999-"}) {
    const Answer answer = answerTo(range);
    EXPECT_EQ(answer.status, 416) << range;
    EXPECT_THAT(answer.headers, testing::Contains(testing::Pair("Content-Range", "bytes */10")));
  }
}

// With many overlapping ranges cpp-httplib 0.11.4 would put together the file so many times.
TEST_F(RangeTest, AnythingElseIsAnsweredWithTheWholeFile) {
  for (const char* range : {"", "bytes=0-1,0-1,0-1", "bytes=3-1", "bytes=a-b", "bytes=", "bytes=-",
                            "lines=1-2", "bytes=18446744073709551616-", "bytes=0-18446744073709551616"}) {
    Answer answer = answerTo(range);
    EXPECT_EQ(answer.status, 200) << range;
    EXPECT_EQ(contentOf(*answer.body), "0123456789") << range;
  }
}

TEST(GrowingFile, IsFollowedToItsLastByte) {
  const base::TempFolder folder;
  const auto path = folder.path() / "growing";
  std::vector<std::string> pieces{"one", "two", "three"};
  std::size_t written = 0;
  // Each look finds one piece more; the last one is written as the run ends.
  const auto is_finished = [&] {
    if (written < pieces.size()) std::ofstream(path, std::ios::app) << pieces[written++];
    return written == pieces.size();
  };
  const auto open = [&path] { return base::UniqueFd(::open(path.c_str(), O_RDONLY | O_CLOEXEC)); };
  GrowingFileBody body(open, 2, is_finished);
  EXPECT_EQ(contentOf(body), "etwothree");
}

TEST(GrowingFile, ThatNeverCameIsEmpty) {
  int looks = 0;
  GrowingFileBody body([] { return base::UniqueFd(); }, 0, [&looks] { return ++looks == 3; });
  EXPECT_EQ(contentOf(body), "");
  EXPECT_EQ(looks, 3);
}

TEST(GrowingFile, IsLeftWhenNobodyWaitsForIt) {
  GrowingFileBody body([] { return base::UniqueFd(); }, 0, [] { return false; });
  EXPECT_EQ(body.next([] { return true; }), std::nullopt);
}

TEST(LineTail, HandsOnWholeLines) {
  const base::TempFolder folder;
  const auto path = folder.path() / "log";
  LineTail tail(path.string());
  std::vector<std::string> lines;
  const auto take = [&lines](const std::string& line) { lines.push_back(line); };
  tail.read(take);
  std::ofstream file(path, std::ios::app);
  file << "one\ntw" << std::flush;
  tail.read(take);
  EXPECT_THAT(lines, testing::ElementsAre("one"));
  file << "o\n\nfour" << std::flush;
  tail.read(take);
  tail.read(take, true);
  EXPECT_THAT(lines, testing::ElementsAre("one", "two", "", "four"));
  file << std::string(3 * LineTail::kLongestLine, 'x') << "\n" << std::flush;
  tail.read(take);
  EXPECT_EQ(lines.back().size(), LineTail::kLongestLine);
}

}  // namespace
}  // namespace kerfbench::serve
