// SPDX-License-Identifier: Apache-2.0
// Devices of the STM32F103 beside its timers: flash, single bits, pins, clocks of devices, code in SRAM.
#include <gmock/gmock.h>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::ElementsAre;

using CortexMDevice = CortexM;

TEST_F(CortexMDevice, FlashIsErasedAndProgrammedAsItsInterfaceSays) {
  const auto result = run("flash", 100 * kMs);
  EXPECT_THAT(linesOf(result.uart), ElementsAre("128",         // locked
                                                "4",           // PGERR
                                                "0",           // unlocked
                                                "1450709556",  // 0x56781234
                                                "32",          // EOP
                                                "4", "4660",   // PGERR, and 0x1234 as before
                                                "4294967295"));
}

TEST_F(CortexMDevice, SingleBitsHaveAnAliasOfTheirOwn) {
  const auto result = run("bits", 20 * kMs);
  EXPECT_THAT(linesOf(result.uart), ElementsAre("2147483680", "1", "0"));
  EXPECT_EQ(edgesOf(result.events, {0, 3}).size(), 1U);
  EXPECT_EQ(edgesOf(result.events, {0, 3}, false).size(), 1U);
}

TEST_F(CortexMDevice, AnOpenDrainIsHighWhenReleased) {
  const auto result = run("open_drain", 20 * kMs);
  EXPECT_THAT(linesOf(result.uart), ElementsAre("1", "0", "1"));
}

TEST_F(CortexMDevice, AnOpenDrainThatIsHeldDownReadsLow) {
  const auto source = openChild(optionsFor("open_drain"));
  source->drive(kPA0, false, 1);
  EXPECT_THAT(linesOf(runSource(*source, 20 * kMs, kMs).uart), ElementsAre("0", "0", "0"));
}

TEST_F(CortexMDevice, WithoutItsClockADeviceReadsZeroAndTakesNoNotice) {
  EXPECT_THAT(linesOf(run("clock_off", 20 * kMs).uart), ElementsAre("0", "0", "65535", "5"));
}

TEST_F(CortexMDevice, CodeInTheSramRunsAsItIsWhenItRuns) {
  EXPECT_THAT(linesOf(run("from_sram", 20 * kMs).uart), ElementsAre("1", "2", "3"));
}

TEST_F(CortexMDevice, DmaThatLeavesTheMemoryReportsAnError) {
  // Flags of channel 7: error and any; the channel is off.
  EXPECT_THAT(linesOf(run("huge_dma", 50 * kMs).uart), ElementsAre("9", "0"));
}

}  // namespace
}  // namespace kerfbench::source::cortex_m
