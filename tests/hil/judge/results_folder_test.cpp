// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/results_folder.h"

#include <gtest/gtest.h>

#include <string>
#include <system_error>

#include "hil/base/input_error.h"
#include "hil/judge/results_list.h"
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
  {
    ResultsFolder folder(temp.path(), "label");
    write(folder.staging() / "old", "old");
    folder.commit();
  }
  {
    ResultsFolder folder(temp.path(), "label");
    write(folder.staging() / "half", "half");
  }
  EXPECT_EQ(base::contentOf(temp.path() / "label" / "old"), "old");
  EXPECT_FALSE(fs::exists(temp.path() / "label" / "half"));
  EXPECT_EQ(temp.entries(), 1);
}

/// What refuseForeignResults() says of `label` in the folder; empty if nothing.
std::string refusal(const base::TempFolder& temp) {
  try {
    refuseForeignResults(temp.path(), "label");
    return {};
  } catch (const base::InputError& e) {
    return e.what();
  }
}

TEST(ResultsFolder, DeletesNothingThatNoRunWrote) {
  const base::TempFolder temp;
  const fs::path place = temp.path() / "label";
  EXPECT_EQ(refusal(temp), "");
  write(place, "a file of somebody's");
  EXPECT_NE(refusal(temp).find("is no folder"), std::string::npos) << refusal(temp);
  fs::remove(place);
  fs::create_directory(place);
  EXPECT_EQ(refusal(temp), "");
  write(place / "thesis.txt", "years of work");
  EXPECT_NE(refusal(temp).find("is no results folder"), std::string::npos) << refusal(temp);
  {
    ResultsFolder folder(temp.path(), "label");
    write(folder.staging() / "verdict.json", "{}");
    EXPECT_THROW(folder.commit(), base::InputError);
  }
  EXPECT_EQ(base::contentOf(place / "thesis.txt"), "years of work");
  EXPECT_EQ(temp.entries(), 1);
}

TEST(ResultsFolder, DeletesNothingThatWasPutBesideResultsLater) {
  const base::TempFolder temp;
  const fs::path place = temp.path() / "label";
  {
    ResultsFolder folder(temp.path(), "label");
    fs::create_directory(folder.staging() / "spot");
    write(folder.staging() / "spot" / "frames", "0");
    write(folder.staging() / "verdict.json", "{}");
    folder.commit();
  }
  EXPECT_EQ(refusal(temp), "");
  write(place / "spot" / "note.txt", "mine");
  EXPECT_NE(refusal(temp).find("holds 'spot/note.txt'"), std::string::npos) << refusal(temp);
  fs::remove(place / "spot" / "note.txt");
  fs::create_directory(place / "kept");
  EXPECT_NE(refusal(temp).find("holds 'kept'"), std::string::npos) << refusal(temp);
}

/// Writes results of two files.
fs::path written(const base::TempFolder& temp) {
  ResultsFolder folder(temp.path(), "label");
  fs::create_directory(folder.staging() / "spot");
  write(folder.staging() / "spot" / "frames", "0");
  write(folder.staging() / "verdict.json", "{}");
  folder.commit();
  return folder.place();
}

TEST(ResultsList, HasTheSumsThatSha256sumPrints) {
  const base::TempFolder temp;
  EXPECT_EQ(base::contentOf(written(temp) / kResultsList),
            "Results of kerfbench. The bench removes or replaces the folder only as long as it holds these "
            "files alone:\n"
            "5feceb66ffc86f38d952786c6d696c79c2dbc239dd4e91b46729d73a27fb57e9  spot/frames\n"
            "44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a  verdict.json\n");
}

// The head line of earlier benches.
TEST(ResultsList, OfAnEarlierBenchIsRead) {
  const base::TempFolder temp;
  const fs::path folder = written(temp);
  const std::string list = base::contentOf(folder / kResultsList);
  write(folder / kResultsList,
        "Results of kerfbench. The next run of this name replaces the folder as long as it holds these files "
        "alone:" +
            list.substr(list.find('\n')));
  EXPECT_EQ(changedSinceListed(folder), std::vector<std::string>());
  EXPECT_EQ(foreignIn(folder), "");
}

TEST(ResultsList, TellsWhatWasChangedTakenAwayAndAdded) {
  const base::TempFolder temp;
  const fs::path place = written(temp);
  EXPECT_EQ(changedSinceListed(place), std::vector<std::string>{});
  write(place / "verdict.json", "{ }");
  fs::remove(place / "spot" / "frames");
  write(place / "note.txt", "mine");
  EXPECT_EQ(changedSinceListed(place),
            (std::vector<std::string>{"spot/frames is missing", "verdict.json is not what the run wrote",
                                      "note.txt was added", "spot was added"}));
}

// Results of an older program may be replaced, and nothing vouches for them.
TEST(ResultsList, OfOnlyNamesVouchesForNothing) {
  const base::TempFolder temp;
  const fs::path place = written(temp);
  std::string list = base::contentOf(place / kResultsList);
  list = list.substr(0, list.find('\n') + 1);
  write(place / kResultsList, list + "spot/frames\nverdict.json\n");
  EXPECT_EQ(refusal(temp), "");
  EXPECT_EQ(changedSinceListed(place), (std::vector<std::string>{"spot/frames has no sum in the list",
                                                                 "verdict.json has no sum in the list"}));
}

TEST(ResultsList, IsWhatMakesAFolderOneOfResults) {
  const base::TempFolder temp;
  EXPECT_THROW((void)changedSinceListed(temp.path()), base::InputError);
  EXPECT_THROW((void)changedSinceListed(temp.path() / "nothing"), base::InputError);
}

TEST(ResultsFolder, ALinkIsNotReplaced) {
  const base::TempFolder temp;
  fs::create_directory(temp.path() / "elsewhere");
  fs::create_directory_symlink(temp.path() / "elsewhere", temp.path() / "label");
  EXPECT_NE(refusal(temp).find("is no folder"), std::string::npos) << refusal(temp);
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
