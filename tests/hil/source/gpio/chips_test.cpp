// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/chips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "tests/hil/source/gpio/fake_libgpiod.h"
#include "tests/hil/source/words_of.h"

namespace kerfbench::source {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ChipsTest : public testing::Test {
 protected:
  ChipsTest() {
    fake_libgpiod = {};
    fake_libgpiod.lines = {{"PUL", "", false, false, false},
                           {"DIR", "heartbeat", true, true, false},
                           {"", "", false, false, true},
                           {"PUL", "", false, false, false}};
    fs::create_directories(dev);
    for (const char* name : {"gpiochip10", "gpiochip2", "gpiochipper", "gpio", "null"})
      std::ofstream(dev / name);
  }
  ~ChipsTest() override {
    fs::remove_all(dev);
    EXPECT_EQ(fake_libgpiod.open_chips, 0);
  }
  const fs::path dev = fs::path(testing::TempDir()) / ("kerfbench_chips_" + std::to_string(::getpid()));
};

TEST_F(ChipsTest, ListsChipsByNumberWithTheirLines) {
  const GpioChipList list = listChips(dev);
  ASSERT_EQ(list.chips.size(), 2U);
  EXPECT_EQ(list.chips[0].name, "gpiochip2");
  EXPECT_EQ(list.chips[1].name, "gpiochip10");
  EXPECT_EQ(list.chips[0].path, dev / "gpiochip2");
  EXPECT_EQ(list.chips[0].label, "sim");
  ASSERT_EQ(list.chips[0].lines.size(), 4U);
  const GpioLineInfo& dir = list.chips[0].lines[1];
  EXPECT_EQ(dir.offset, 1U);
  EXPECT_EQ(dir.name, "DIR");
  EXPECT_EQ(dir.consumer, "heartbeat");
  EXPECT_TRUE(dir.used);
  EXPECT_TRUE(dir.output);
  EXPECT_FALSE(dir.active_low);
  EXPECT_EQ(list.chips[0].lines[2].name, "");
  EXPECT_TRUE(list.chips[0].lines[2].active_low);
}

TEST_F(ChipsTest, AChipThatCannotBeReadIsAFaultInWordsAndTheOthersAreListed) {
  const std::vector<std::pair<int, const char*>> cases{
      {EACCES, "udev"}, {ENOTTY, "is no gpiochip"}, {EINVAL, "is no gpiochip"}, {ENODEV, "has gone"}};
  for (const auto& [error, words] : cases) {
    fake_libgpiod.open_error = error;
    const GpioChipList list = listChips(dev);
    EXPECT_THAT(list.chips, IsEmpty());
    EXPECT_THAT(list.faults, ElementsAre(HasSubstr(words), HasSubstr(words)));
  }
}

TEST_F(ChipsTest, AChipThatVanishesWhileItIsReadIsAFault) {
  fake_libgpiod.line_error = ENODEV;
  EXPECT_THAT(wordsOf<GpioError>([&] { readChip(dev / "gpiochip2"); }), HasSubstr("has gone"));
  fake_libgpiod.info_error = ENODEV;
  EXPECT_THAT(wordsOf<GpioError>([&] { readChip(dev / "gpiochip2"); }), HasSubstr("has gone"));
}

TEST_F(ChipsTest, AMissingFolderIsAFault) {
  EXPECT_THAT(listChips(dev / "none").faults, ElementsAre(HasSubstr("No such file")));
}

TEST_F(ChipsTest, AChipIsFoundByPathNameOrLabel) {
  GpioChipList list = listChips(dev);
  EXPECT_EQ(findChip(list, "gpiochip10").name, "gpiochip10");
  EXPECT_EQ(findChip(list, (dev / "gpiochip2").string()).name, "gpiochip2");
  EXPECT_THAT(wordsOf<GpioError>([&] { findChip(list, "sim"); }), HasSubstr("2 chips have the label 'sim'"));
  list.chips[1].label = "other";
  EXPECT_EQ(findChip(list, "sim").name, "gpiochip2");
}

TEST_F(ChipsTest, AChipThatIsNotThereIsToldWithThoseThatAre) {
  fake_libgpiod.label = "sim";
  const GpioChipList list = listChips(dev);
  EXPECT_THAT(wordsOf<GpioError>([&] { findChip(list, "gpiochip0"); }), HasSubstr("gpiochip2 (sim), "));
  GpioChipList none;
  none.faults = {"/dev/gpiochip0: not allowed"};
  EXPECT_THAT(wordsOf<GpioError>([&] { findChip(none, "gpiochip0"); }),
              HasSubstr("none that can be read\n/dev/gpiochip0: not"));
}

TEST_F(ChipsTest, ALineIsFoundByNumberOrByAnUnambiguousName) {
  const GpioChipInfo chip = readChip(dev / "gpiochip2");
  EXPECT_EQ(findLine(chip, "2").offset, 2U);
  EXPECT_EQ(findLine(chip, "DIR").offset, 1U);
  EXPECT_THAT(wordsOf<GpioError>([&] { findLine(chip, "4"); }), HasSubstr("has no line 4: it has 4"));
  EXPECT_THAT(wordsOf<GpioError>([&] { findLine(chip, "PUL"); }),
              HasSubstr("several lines of the name 'PUL'"));
  EXPECT_THAT(wordsOf<GpioError>([&] { findLine(chip, "ENA"); }), HasSubstr("no line of the name 'ENA'"));
  EXPECT_THAT(wordsOf<GpioError>([&] { findLine(chip, ""); }), HasSubstr("no line of the name ''"));
}

}  // namespace
}  // namespace kerfbench::source
