// SPDX-License-Identifier: Apache-2.0
#include "hil/base/file_content.h"

#include <cerrno>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

TEST(FileContent, IsEveryByte) {
  const TempFolder folder;
  const std::string content = std::string("a\0\r\n", 4) + std::string(200'000, 'x');
  EXPECT_EQ(fileContent(folder.write("all", content)), content);
  EXPECT_EQ(fileContent(folder.write("empty", "")), "");
}

TEST(FileContent, IsNothingWhereThereIsNoFile) {
  const TempFolder folder;
  EXPECT_EQ(fileContent(folder.path() / "missing"), std::nullopt);
  EXPECT_EQ(errno, ENOENT);
  EXPECT_EQ(fileContent(folder.path()), std::nullopt);
  EXPECT_EQ(errno, EINVAL);
}

}  // namespace
}  // namespace kerfbench::base
