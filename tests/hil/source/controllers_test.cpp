// SPDX-License-Identifier: Apache-2.0
#include "hil/source/controllers.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::source {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Controllers, OneIsFoundByAnyOfItsNames) {
  for (const char* name : {"atmega328p", "atmega328"}) {
    const auto found = emulatedControllers(KERFBENCH_AVR_CHILD, name);
    ASSERT_EQ(found.size(), 1U) << name;
    EXPECT_TRUE(found[0].isCalled(name));
    // Data sheet of the ATmega328P: 32, 2 and 1 KiB, ports B to D, timers 0 to 2, one USART.
    EXPECT_EQ(found[0].flash_bytes, 32768U);
    EXPECT_EQ(found[0].sram_bytes, 2048U);
    EXPECT_EQ(found[0].eeprom_bytes, 1024U);
    EXPECT_EQ(found[0].ports, "BCD");
    EXPECT_EQ(found[0].timers, "012");
    EXPECT_EQ(found[0].uarts, "0");
  }
}

TEST(Controllers, AllAreTheAnswerToANameThatNoneHas) {
  const auto all = emulatedControllers(KERFBENCH_AVR_CHILD, "z80");
  EXPECT_GE(all.size(), 20U);
  const auto mega = std::ranges::find_if(all, [](const Controller& c) { return c.isCalled("atmega2560"); });
  ASSERT_NE(mega, all.end());
  EXPECT_EQ(mega->ports, "ABCDEFGHJKL");
  EXPECT_EQ(mega->timers, "012345");
  EXPECT_EQ(mega->uarts, "0123");
  EXPECT_EQ(mega->flash_bytes, 262144U);
}

// simavr falls over its own tables of this one.
TEST(Controllers, OneThatTheEmulatorCannotStartIsNone) {
  const auto all = emulatedControllers(KERFBENCH_AVR_CHILD, "atmega64m1");
  EXPECT_GE(all.size(), 20U);
  EXPECT_FALSE(std::ranges::any_of(all, [](const Controller& c) { return c.isCalled("atmega64m1"); }));
}

TEST(Controllers, ThePageListsThemAll) {
  const std::string page =
      base::contentOf(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs/reference/avr-controllers.md");
  const auto all = emulatedControllers(KERFBENCH_AVR_CHILD, "none of them");
  const auto listed = [](const std::string& names, const std::string& before) {
    std::string text;
    for (const char name : names) text += (text.empty() ? "" : ", ") + before + name;
    return text.empty() ? std::string("none") : text;
  };
  for (const Controller& c : all) {
    std::string names;
    for (const std::string& name : c.names) names += (names.empty() ? "" : ", ") + name;
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | {} | {} | {} | {} | {} | {} |\n", names, c.flash_bytes,
                                            c.sram_bytes, c.eeprom_bytes, listed(c.ports, "P"),
                                            listed(c.timers, ""), listed(c.uarts, ""))));
  }
  EXPECT_EQ(std::ranges::count(page, '\n') - std::ranges::count(page.substr(0, page.find("|---|")), '\n') - 1,
            static_cast<std::ptrdiff_t>(all.size()));
}

TEST(Controllers, NamesMostLikeAnotherComeByTheLettersThatMustChange) {
  const std::vector<Controller> all{{.names = {"atmega168", "atmega168p"}},
                                    {.names = {"atmega328p"}},
                                    {.names = {"attiny85"}},
                                    {.names = {"atmega2560"}}};
  EXPECT_THAT(namesLike("atmega328pb", all), ElementsAre("atmega328p", "atmega168p", "atmega168"));
  EXPECT_EQ(namesLike("tiny85", all).front(), "attiny85");
  EXPECT_EQ(namesLike("2560", all).front(), "atmega2560");
  EXPECT_TRUE(namesLike("anything", {}).empty());
}

TEST(Controllers, PinsAreThoseOfItsPorts) {
  const Controller controller{.ports = "BCD"};
  EXPECT_TRUE(controller.hasPin({1, 0}));
  EXPECT_TRUE(controller.hasPin({3, 7}));
  EXPECT_FALSE(controller.hasPin({3, 8}));
  EXPECT_FALSE(controller.hasPin({0, 2}));
  EXPECT_FALSE(controller.hasPin({30, 0}));
  EXPECT_EQ(controller.nameOf({3, 7}), "PD7");
}

TEST(Controllers, PortsMayHaveNumbersAndMoreBits) {
  const Controller numbered{.ports = "0123"};
  EXPECT_TRUE(numbered.hasPin({3, 7}));
  EXPECT_FALSE(numbered.hasPin({4, 0}));
  EXPECT_FALSE(numbered.hasPin({12, 0}));
  EXPECT_EQ(numbered.nameOf({1, 2}), "P1.2");
  const Controller wide{.ports = "ABC", .port_bits = 16};
  EXPECT_TRUE(wide.hasPin({2, 13}));
  EXPECT_FALSE(wide.hasPin({2, 16}));
}

TEST(Controllers, AProgramThatDoesNotSayIsAnError) {
  EXPECT_THAT([] { (void)emulatedControllers("/bin/true", "atmega328p"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("exit status 0")));
  EXPECT_THAT([] { (void)emulatedControllers("/bin/cat", "atmega328p"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("does not say what it emulates")));
}

}  // namespace
}  // namespace kerfbench::source
