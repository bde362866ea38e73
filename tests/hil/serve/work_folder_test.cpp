// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/work_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "hil/serve/refusal.h"
#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;

class WorkFolderTest : public testing::Test {
 protected:
  WorkFolderTest() { bench_.write("work/a.dxf", "drawing"); }

  /// Status of the refusal; 0: it was opened.
  [[nodiscard]] int refusalOfOpen(const std::string& name) const {
    try {
      (void)files_.open(name);
    } catch (const Refusal& refusal) {
      return refusal.status();
    }
    return 0;
  }
  [[nodiscard]] int refusalOfWrite(const std::string& name) const {
    try {
      files_.write(name, [](const auto& take) { take("new"); });
    } catch (const Refusal& refusal) {
      return refusal.status();
    }
    return 0;
  }

  InstalledBench bench_;
  WorkFolder files_{bench_.work(), shippedFolders(bench_.path("lib/kerfbench/bin"))};
};

TEST_F(WorkFolderTest, OpensItsFilesAndThoseThatComeWithTheBench) {
  EXPECT_EQ(refusalOfOpen("a.dxf"), 0);
  EXPECT_EQ(refusalOfOpen("shipped/scenarios/label.yaml"), 0);
  EXPECT_EQ(files_.nameOf(files_.pathOf("a.dxf")), "a.dxf");
  EXPECT_EQ(files_.nameOf(files_.pathOf("shipped/scenarios/label.yaml")), "shipped/scenarios/label.yaml");
  EXPECT_EQ(files_.nameOf("/etc/passwd"), "");
  EXPECT_EQ(refusalOfOpen("b.dxf"), 404);
}

TEST_F(WorkFolderTest, LeadsNowhereElse) {
  bench_.write("outside.txt", "secret");
  fs::create_symlink(bench_.path("outside.txt"), bench_.path("work/link.dxf"));
  fs::create_symlink("../outside.txt", bench_.path("work/near.dxf"));
  fs::create_symlink("..", bench_.path("work/up"));
  fs::create_symlink("a.dxf", bench_.path("work/inside.dxf"));
  for (const std::string name :
       {"../outside.txt", "up/outside.txt", "link.dxf", "near.dxf", "/etc/passwd", "", ".", "..",
        "a/../a.dxf", "a.dxf/", "//a.dxf", "shipped/../outside.txt", "shipped/firmware/../bin/kerfbench",
        ".hidden", "sub/.hidden", "a\\b", "a\nb", "\xff.dxf", "\xed\xa0\x80.dxf"})
    EXPECT_THAT(refusalOfOpen(name), testing::AnyOf(400, 403, 404)) << name;
  EXPECT_EQ(refusalOfOpen(std::string("a.dxf\0x", 7)), 400);
  EXPECT_EQ(refusalOfOpen(std::string(100'000, 'a')), 400);
  EXPECT_EQ(refusalOfOpen(std::string(400, 'a')), 400);
  EXPECT_EQ(refusalOfOpen("inside.dxf"), 0);
}

TEST_F(WorkFolderTest, APipeKeepsNobodyWaiting) {
  ASSERT_EQ(::mkfifo(bench_.path("work/pipe.dxf").c_str(), 0600), 0);
  EXPECT_EQ(refusalOfOpen("pipe.dxf"), 404);
}

TEST_F(WorkFolderTest, WritesOnlyPlainNamesOfWhatAWindowNeeds) {
  EXPECT_EQ(refusalOfWrite("jobs/My job-2.yaml"), 0);
  EXPECT_EQ(base::contentOf(bench_.path("work/jobs/My job-2.yaml")), "new");
  for (const std::string name : {"-rf.yaml", "jobs/-rf.yaml", "a;b.yaml", "a$(b).yaml", "a'b.yaml",
                                 "\xc3\xa4.yaml", "results/a.yaml", "a/b/c/d/e/f/g/h/i/j/k/l/m.yaml"})
    EXPECT_EQ(refusalOfWrite(name), 400) << name;
  for (const std::string name : {"a.sh", "a.so", "a.html", "a.js", "a", "Makefile", "a.yaml.desktop"})
    EXPECT_EQ(refusalOfWrite(name), 415) << name;
  EXPECT_EQ(refusalOfWrite("shipped/scenarios/label.yaml"), 403);
}

TEST_F(WorkFolderTest, WritesThroughNoLink) {
  fs::create_directories(bench_.path("elsewhere"));
  fs::create_symlink(bench_.path("elsewhere"), bench_.path("work/out"));
  EXPECT_EQ(refusalOfWrite("out/a.yaml"), 403);
  EXPECT_TRUE(fs::is_empty(bench_.path("elsewhere")));
  // A link in the place of the file is replaced, and what it led to stays.
  bench_.write("elsewhere/kept.yaml", "kept");
  fs::create_symlink(bench_.path("elsewhere/kept.yaml"), bench_.path("work/b.yaml"));
  EXPECT_EQ(refusalOfWrite("b.yaml"), 0);
  EXPECT_EQ(base::contentOf(bench_.path("elsewhere/kept.yaml")), "kept");
  EXPECT_EQ(base::contentOf(bench_.path("work/b.yaml")), "new");
}

TEST_F(WorkFolderTest, WritesWholeOrNotAtAll) {
  const auto broken = [](const std::function<void(std::string_view)>& take) {
    take("half");
    throw Refusal(400, "the rest did not come");
  };
  EXPECT_THROW(files_.write("a.dxf", broken), Refusal);
  EXPECT_EQ(base::contentOf(bench_.path("work/a.dxf")), "drawing");
  EXPECT_EQ(std::distance(fs::directory_iterator(bench_.work()), {}), 1) << "something was left behind";
  EXPECT_EQ(fs::status(bench_.path("work/a.dxf")).permissions() & fs::perms::owner_exec, fs::perms::none);
}

}  // namespace
}  // namespace kerfbench::serve
