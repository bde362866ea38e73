// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/results_folder.h"

#include <gtest/gtest.h>

#include <system_error>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::judge {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& content) { std::ofstream(path) << content; }

TEST(ResultsFolder, AppearsWholeWithTheCommit) {
  const base::TempFolder temp;
  {
    ResultsFolder folder(temp.path() / "deep" / "results", "label");
    write(folder.staging() / "verdict.json", "{}");
    EXPECT_EQ(folder.place(), temp.path() / "deep" / "results" / "label");
    EXPECT_FALSE(fs::exists(folder.place()));
    folder.commit();
    EXPECT_EQ(base::contentOf(folder.place() / "verdict.json"), "{}");
  }
  EXPECT_EQ(base::contentOf(temp.path() / "deep" / "results" / "label" / "verdict.json"), "{}");
}

TEST(ResultsFolder, ReplacesAnOlderOneWholly) {
  const base::TempFolder temp;
  for (const std::string round : {"first", "second", "third"}) {
    ResultsFolder folder(temp.path(), "label");
    write(folder.staging() / round, round);
    folder.commit();
  }
  EXPECT_EQ(base::contentOf(temp.path() / "label" / "third"), "third");
  EXPECT_FALSE(fs::exists(temp.path() / "label" / "first"));
  EXPECT_FALSE(fs::exists(temp.path() / "label" / "second"));
  EXPECT_EQ(temp.entries(), 1);
}

TEST(ResultsFolder, WithoutACommitTheOldOneStaysAndNothingIsLeft) {
  const base::TempFolder temp;
  fs::create_directories(temp.path() / "label");
  write(temp.path() / "label" / "old", "old");
  {
    ResultsFolder folder(temp.path(), "label");
    write(folder.staging() / "half", "half");
  }
  EXPECT_EQ(base::contentOf(temp.path() / "label" / "old"), "old");
  EXPECT_FALSE(fs::exists(temp.path() / "label" / "half"));
  EXPECT_EQ(temp.entries(), 1);
}

TEST(ResultsFolder, OthersMayReadIt) {
  const base::TempFolder temp;
  ResultsFolder folder(temp.path(), "label");
  folder.commit();
  const auto all_read = fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read;
  EXPECT_EQ(fs::status(folder.place()).permissions() & all_read, all_read);
}

TEST(ResultsFolder, NamesTheFolderThatCannotBeMade) {
  const base::TempFolder temp;
  const auto file = temp.write("file", "in the way");
  try {
    ResultsFolder folder(file / "results", "label");
    FAIL() << "no exception";
  } catch (const std::system_error& e) {
    EXPECT_NE(std::string(e.what()).find(file.string()), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace kerfbench::judge
