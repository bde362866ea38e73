// SPDX-License-Identifier: Apache-2.0
#include "hil/base/atomic_file.h"

#include <gtest/gtest.h>

#include <iterator>
#include <system_error>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "kerfbench_atomic_file";
};

TEST_F(AtomicFileTest, ReplacesAFileAndLeavesNothingBeside) {
  writeFileAtomically(folder_ / "a", "old");
  writeFileAtomically(folder_ / "a", std::string("new\0content", 11));
  EXPECT_EQ(contentOf(folder_ / "a"), std::string("new\0content", 11));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(AtomicFileTest, LeavesTheOldFileAndNoRestWhenItCannotReplace) {
  std::filesystem::create_directories(folder_ / "a" / "occupied");
  EXPECT_THROW(writeFileAtomically(folder_ / "a", "x"), std::system_error);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a" / "occupied"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(AtomicFileTest, NamesFileAndFolderWhenTheFolderIsMissingOrNone) {
  writeFileAtomically(folder_ / "file", "x");
  for (const char* folder : {"missing", "file"}) {
    try {
      writeFileAtomically(folder_ / folder / "a", "x");
      ADD_FAILURE() << "no exception";
    } catch (const FolderError& e) {
      const std::string text = e.what();
      EXPECT_NE(text.find((folder_ / folder / "a").string() + " cannot be written: its folder " +
                          (folder_ / folder).string() + " cannot be used: "),
                std::string::npos)
          << text;
    }
  }
}

}  // namespace
}  // namespace kerfbench::base
