// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "hil/source/controllers.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::source {
namespace {

using ::testing::HasSubstr;

TEST(Mcs51Parts, OneIsFoundByAnyOfItsNames) {
  for (const char* name : {"80c52", "8052", "8752"}) {
    const auto found = emulatedControllers(KERFBENCH_MCS51_CHILD, name);
    ASSERT_EQ(found.size(), 1U) << name;
    EXPECT_TRUE(found[0].isCalled(name));
    // Intel 1994: 8 KiB of code, 256 bytes of RAM, four ports, three timers.
    EXPECT_EQ(found[0].flash_bytes, 8192U);
    EXPECT_EQ(found[0].sram_bytes, 256U);
    EXPECT_EQ(found[0].eeprom_bytes, 0U);
    EXPECT_EQ(found[0].ports, "0123");
    EXPECT_EQ(found[0].timers, "012");
    EXPECT_EQ(found[0].uarts, "0");
  }
}

TEST(Mcs51Parts, ThePageListsThemAll) {
  const std::string page =
      base::contentOf(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs/reference/mcs51-controllers.md");
  const auto all = emulatedControllers(KERFBENCH_MCS51_CHILD, "none of them");
  EXPECT_GE(all.size(), 10U);
  const auto listed = [](const std::string& names, const std::string& before) {
    std::string text;
    for (const char name : names) text += (text.empty() ? "" : ", ") + before + name;
    return text;
  };
  for (const Controller& c : all) {
    std::string names;
    for (const std::string& name : c.names) names += (names.empty() ? "" : ", ") + name;
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | {} | {} | {} | {} | ", names, c.flash_bytes,
                                            c.sram_bytes, listed(c.ports, "P"), listed(c.timers, ""))));
  }
  const std::string table = page.substr(page.find("|---|"));
  EXPECT_EQ(std::ranges::count(table.substr(0, table.find("\n\n")), '\n'),
            static_cast<std::ptrdiff_t>(all.size()));
}

}  // namespace
}  // namespace kerfbench::source
