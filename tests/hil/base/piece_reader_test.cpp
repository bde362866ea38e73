// SPDX-License-Identifier: Apache-2.0
#include "hil/base/piece_reader.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "hil/base/digest.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

std::string longText() {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += std::to_string(i) + "\n";
  return text;
}

TEST(PieceReader, GivesAFileInPieces) {
  const TempFolder folder;
  const std::string text = longText();
  PieceReader file(folder.write("long", text), "long");
  EXPECT_EQ(file.size(), text.size());
  std::string all;
  std::size_t pieces = 0;
  forEachPiece(file, text.size() - 1, [&](std::string_view piece) {
    all += piece;
    ++pieces;
  });
  EXPECT_EQ(all, text.substr(0, text.size() - 1));
  EXPECT_GT(pieces, 3U);
  file.seek(text.size() - 7);
  std::vector<char> end(100);
  EXPECT_EQ(file.read(end), 7U);
  EXPECT_EQ(file.read(end), 0U);
}

TEST(PieceReader, DigestOfAFileIsThatOfItsBytes) {
  const TempFolder folder;
  const std::string text = longText();
  std::vector<std::string> told;
  EXPECT_EQ(
      sha256File(folder.write("long", text), [&](double, const std::string& what) { told.push_back(what); }),
      sha256(text));
  EXPECT_TRUE(told.empty()) << "a file that takes no time is not told";
  Sha256 sum;
  sum.add(std::string_view(text).substr(0, 1000));
  EXPECT_EQ(sum.digest(), sha256(text.substr(0, 1000)));
  sum.add(std::string_view(text).substr(1000));
  EXPECT_EQ(sum.digest(), sha256(text));
}

TEST(PieceReader, RefusesWhatIsNoFileWithItsName) {
  const TempFolder folder;
  const auto wordsFor = [](const std::filesystem::path& path) {
    try {
      const PieceReader file(path, "cannot read " + path.string());
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto missing = folder.path() / "missing";
  EXPECT_EQ(wordsFor(folder.path()),
            "cannot read " + folder.path().string() + ": is a folder, no regular file");
  EXPECT_EQ(wordsFor(missing), "cannot read " + missing.string() + ": No such file or directory");
}

}  // namespace
}  // namespace kerfbench::base
