// SPDX-License-Identifier: Apache-2.0
// Parts that the emulator of the STM32F103 has, and the page that lists them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "hil/source/controllers.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::HasSubstr;

using CortexMParts = CortexM;

TEST_F(CortexMParts, OneIsFoundByAnyOfItsNames) {
  for (const char* name : {"stm32f103c8", "stm32f103c8t6"}) {
    const auto found = emulatedControllers(KERFBENCH_CORTEX_M_CHILD, name);
    ASSERT_EQ(found.size(), 1U) << name;
    // DS5319: 64 and 20 KiB, ports A to D in 48 pins, four timers, three USARTs.
    EXPECT_EQ(found[0].flash_bytes, 65536U);
    EXPECT_EQ(found[0].sram_bytes, 20480U);
    EXPECT_EQ(found[0].eeprom_bytes, 0U);
    EXPECT_EQ(found[0].timers, "1234");
    EXPECT_EQ(found[0].uarts, "123");
    EXPECT_TRUE(found[0].hasPin({1, 15}));
    EXPECT_FALSE(found[0].hasPin({1, 16}));
    EXPECT_FALSE(found[0].hasPin({4, 0}));
  }
}

TEST_F(CortexMParts, ThePageListsThemAll) {
  const std::string page =
      base::contentOf(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs/reference/cortex-m-controllers.md");
  const auto all = emulatedControllers(KERFBENCH_CORTEX_M_CHILD, "none of them");
  const auto listed = [](const std::string& names, const std::string& before) {
    std::string text;
    for (const char name : names) text += (text.empty() ? "" : ", ") + before + name;
    return text;
  };
  EXPECT_GE(all.size(), 13U);
  for (const Controller& c : all) {
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| {}, {} | {} | {} | {} | {} | {} |\n", c.names.at(0),
                                            c.names.at(1), c.flash_bytes, c.sram_bytes, listed(c.ports, "P"),
                                            listed(c.timers, ""), listed(c.uarts, ""))));
  }
  const std::string row = "\n| stm32f103";
  std::size_t rows = 0;
  for (std::size_t at = page.find(row); at != std::string::npos; at = page.find(row, at + 1)) ++rows;
  EXPECT_EQ(rows, all.size());
}

TEST_F(CortexMParts, ThePageStatesTheStampsError) {
  const std::string page =
      base::contentOf(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs/reference/cortex-m-controllers.md");
  const auto info = openChild(optionsFor("pulses"))->info();
  EXPECT_THAT(page, HasSubstr(fmt::format("**{} ticks**", info.stamp_err_ticks)));
}

}  // namespace
}  // namespace kerfbench::source::cortex_m
