// SPDX-License-Identifier: Apache-2.0
#include "hil/base/installation.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

namespace fs = std::filesystem;

TEST(Installation, OfABuiltBenchHasItsDataInTheSources) {
  const TempFolder source;
  const fs::path bin = source.path() / "build/release/bin";
  fs::create_directories(bin);
  EXPECT_FALSE(isInstalled(bin));
  EXPECT_EQ(shippedData(bin), source.path() / "fixtures");
  EXPECT_EQ(referencePages(bin), source.path() / "docs/reference");
  EXPECT_EQ(windowPages(bin), source.path() / "build/release/window");
}

TEST(Installation, HasItsDataBelowShareWhateverThePrefix) {
  const TempFolder prefix;
  const fs::path bin = prefix.path() / "lib/kerfbench/bin";
  fs::create_directories(bin);
  fs::create_directories(prefix.path() / "share/kerfbench");
  EXPECT_TRUE(isInstalled(bin));
  EXPECT_EQ(shippedData(bin), prefix.path() / "share/kerfbench");
  EXPECT_EQ(referencePages(bin), prefix.path() / "share/kerfbench/reference");
  EXPECT_EQ(windowPages(bin), prefix.path() / "lib/kerfbench/window");
}

}  // namespace
}  // namespace kerfbench::base
