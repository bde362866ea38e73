// SPDX-License-Identifier: Apache-2.0
// Controller that is planned for: read from its image, and from INFO.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/controller/release.h"
#include "firmware_under_test/planner/job/target.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::refusal;
using testing::HasSubstr;

const std::filesystem::path kFirmware = KERFBENCH_FIRMWARE_DIR;

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TEST(Target, TheAvrImageIsWhatIsPlannedForByDefault) {
  const Target target = targetOfImage(kFirmware / "controller-avr.hex");
  EXPECT_EQ(differenceOf(Target{}, target), "");
  EXPECT_EQ(target.name, Target{}.name);
  EXPECT_EQ(target.baud, Target{}.baud);
  EXPECT_EQ(differenceOf(target, targetOfImage(kFirmware / "controller-avr.elf")), "");
  EXPECT_EQ(differenceOf(target, targetOfImage(kFirmware / "controller-native")), "")
      << "the native build steps as the AVR does";
}

TEST(Target, TheGalvoImageIsFaster) {
  const Target target = targetOfImage(kFirmware / "controller-native-galvo");
  EXPECT_DOUBLE_EQ(target.tick_s, 1e-6);
  EXPECT_DOUBLE_EQ(target.periodS(), 128e-6);
  EXPECT_EQ(target.max_steps, 127);
  EXPECT_EQ(target.baud, 2'000'000U);
  EXPECT_THAT(differenceOf(Target{}, target), HasSubstr("periods of 128 us, not 800 us"));
}

TEST(Target, AnImageThatSaysNothingIsRefused) {
  EXPECT_THAT(refusal([] { targetOfImage(written("mute.bin", "no block here")); }),
              HasSubstr("no description"));
  EXPECT_THAT(refusal([] { targetOfImage(kFirmware / "missing.hex"); }), HasSubstr("no such file"));
  const std::string native = textOf(kFirmware / "controller-native");
  EXPECT_THAT(refusal([&] { targetOfImage(written("two.bin", native + native)); }),
              HasSubstr("more than one"));
  // The file is cut off within the block.
  const std::string cut = native.substr(0, native.find(KB_RELEASE_MAGIC) + KB_RELEASE_LEN - 1);
  EXPECT_THAT(refusal([&] { targetOfImage(written("cut.bin", cut)); }), HasSubstr("no description"));
}

TEST(Target, ADamagedHexFileIsRefusedWithItsLine) {
  const std::string good = textOf(kFirmware / "controller-avr.hex");
  const std::size_t second = good.find('\n') + 1;
  for (const auto& [at, byte, why] :
       {std::tuple<std::size_t, char, const char*>{second, ';', "line 2: no Intel hex"},
        {second + 10, good[second + 10] == '0' ? '1' : '0', "line 2: its checksum"},
        {second + 3, 'x', "line 2: no Intel hex"}}) {
    std::string bad = good;
    bad[at] = byte;
    EXPECT_THAT(refusal([&] { targetOfImage(written("bad.hex", bad)); }), HasSubstr(why));
  }
}

TEST(Target, NonsenseInABlockIsNoTarget) {
  const std::string native = textOf(kFirmware / "controller-native");
  const std::string block = native.substr(native.find(KB_RELEASE_MAGIC), KB_RELEASE_LEN);
  for (const std::size_t at : {9U, 13U, 15U, 16U, 19U}) {  // Clock, tick, ticks, steps, baud: all zero.
    std::string bad = block;
    for (std::size_t i = at; i < at + (at == 9 || at == 19 ? 4U : at == 13 ? 2U : 1U); ++i) bad[i] = 0;
    EXPECT_FALSE(targetFrom({reinterpret_cast<const std::uint8_t*>(bad.data()), bad.size()})) << at;
  }
}

TEST(Target, AProgramOfALongDelayIsRefusedWhereTheControllerCannotWaitSoLong) {
  MachineParameters machine = test::twoMirror();
  machine.tracking_delay_s = 7e-3;
  EXPECT_THAT(refusal([&] { plan(test::label(), machine, test::mirrorJob()); }), HasSubstr("0 … 6.375"));
  machine.target = targetOfImage(kFirmware / "controller-native-galvo");
  EXPECT_EQ(refusal([&] { plan(test::label(), machine, test::mirrorJob()); }), "");
  EXPECT_EQ(plan(test::label(), machine, test::mirrorJob()).program.config[11], 7000 >> 8);
}

}  // namespace
}  // namespace kerfbench::planner
