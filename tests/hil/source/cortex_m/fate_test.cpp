// SPDX-License-Identifier: Apache-2.0
// Ends of a run of an STM32F103, and images that never run.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/cortex_m/cortex_m_run.h"
#include "twin/base/random.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using CortexMFate = CortexM;

void expectCrash(std::string_view firmware, const std::string& words) {
  const auto result = run(firmware, 20 * kMs);
  EXPECT_EQ(result.stop, Stop::kCrashed) << firmware << ": " << result.message;
  EXPECT_THAT(result.message, AllOf(HasSubstr(words), HasSubstr("PC 0x"), HasSubstr("cycle")));
}

TEST_F(CortexMFate, CodeThatIsNoneIsACrash) {
  expectCrash("undefined", "the instruction 0xde00 does not exist");
  expectCrash("jump_empty", "crashed at 0x0800f000: the instruction 0xffff does not exist");
  expectCrash("jump_data", "does not exist");
  expectCrash("jump_nowhere", "it goes to 0x30000000, where nothing can be executed");
  expectCrash("jump_arm", "leads out of Thumb");
}

TEST_F(CortexMFate, AnAccessToNothingIsACrashThatNamesIt) {
  expectCrash("bad_read", "it accesses 0x50000010, where there is no memory");
  expectCrash("bad_device", "it writes to 0x40001c00, where there is no device");
}

TEST_F(CortexMFate, AStackThatLeavesTheSramIsACrash) {
  expectCrash("overflow", "it accesses 0x1fff");
  expectCrash("overflow_interrupt", "an exception's frame at 0x1ffffff0 is outside the SRAM");
}

TEST_F(CortexMFate, WhatIsNotModelledEndsTheRunByName) {
  expectCrash("unmodelled", "the firmware writes ADC1 at 0x40012408, which is not modelled");
}

TEST_F(CortexMFate, AnEndlessLoopIsJustTimeThatGoesOn) {
  const auto result = run("hang", 200 * kMs, 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kReached);
  EXPECT_TRUE(result.events.empty());
}

TEST_F(CortexMFate, ResetAfterResetIsJustTimeThatGoesOn) {
  const auto result = run("reset_storm", 200 * kMs, 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kReached) << result.message;
}

TEST_F(CortexMFate, SleepThatNothingEndsIsTheEnd) {
  const auto result = run("halt", 30 * kMs);
  EXPECT_EQ(result.stop, Stop::kEnded);
  EXPECT_THAT(result.message, HasSubstr("sleeps"));
}

TEST_F(CortexMFate, AFloodOfEdgesIsStopped) {
  auto options = optionsFor("flood");
  options.max_events_per_quantum = 1000;
  const auto source = openChild(options);
  Batch batch;
  EXPECT_EQ(source->advance(10 * kMs, batch), Stop::kFlooded);
  EXPECT_EQ(batch.events.size(), 1000U);
  EXPECT_LT(batch.watermark, 10 * kMs);
  EXPECT_EQ(source->advance(20 * kMs, batch), Stop::kFlooded);
  EXPECT_TRUE(batch.events.empty());
}

/// An image with a valid start and vectors into its own bytes, which are drawn.
std::string drawnImage(std::uint64_t seed) {
  const CounterRandom random(seed, 0);
  std::string bytes;
  const auto putWord = [&](std::uint32_t word) {
    for (unsigned i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xFFU);
  };
  for (std::uint64_t i = 0; i < 1024; ++i) {
    const auto drawn = static_cast<std::uint32_t>(random.bits(i));
    if (i == 0) {
      putWord(0x20005000);
    } else if (i < 59) {
      putWord(i == 1 ? 0x08000101 : 0x08000100 + (drawn % 0xE00 | 1U));
    } else {
      putWord(drawn);
    }
  }
  return bytes;
}

TEST_F(CortexMFate, DrawnCodeNeverEndsTheChildItself) {
  const base::TempFolder folder;
  auto options = optionsFor("hang");
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    options.image = folder.write("drawn.bin", drawnImage(seed));
    const auto result = runWith(options, 2 * kMs);
    // A child that has gone, or broken the protocol, is told by other words.
    if (result.stop == Stop::kCrashed) {
      EXPECT_THAT(result.message, HasSubstr("PC 0x")) << "seed " << seed;
    } else {
      EXPECT_NE(result.stop, Stop::kHung) << "seed " << seed;
    }
  }
}

class CortexMImage : public CortexM {
 protected:
  static std::string refusalOf(const ChildSourceOptions& options) {
    try {
      (void)openChild(options);
    } catch (const std::runtime_error& fault) {
      return fault.what();
    }
    return "accepted";
  }
  [[nodiscard]] std::string refusal(const std::string& content, const std::string& name = "image.bin") const {
    auto options = optionsFor("hang");
    options.image = folder_.write(name, content);
    return refusalOf(options);
  }
  static std::string bytesOfWords(std::initializer_list<std::uint32_t> words) {
    std::string bytes;
    for (const std::uint32_t word : words)
      for (unsigned i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xFFU);
    return bytes;
  }
  static std::string contentOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  base::TempFolder folder_;
};

TEST_F(CortexMImage, WithoutAVectorTableIsRefused) {
  EXPECT_THAT(refusal(bytesOfWords({0x12345678, 0x08000101})),
              HasSubstr("no stack pointer in the part's SRAM"));
  EXPECT_THAT(refusal(bytesOfWords({0x20006000, 0x08000101})), HasSubstr("0x20006000, is no stack pointer"));
  EXPECT_THAT(refusal(bytesOfWords({0x20005000, 0x08000100})), HasSubstr("lacks the bit of Thumb"));
  EXPECT_THAT(refusal(bytesOfWords({0x20005000, 0x08010001})), HasSubstr("outside the part's flash"));
}

TEST_F(CortexMImage, ThatDoesNotFitIsRefused) {
  EXPECT_THAT(refusal(std::string(65537, 'x')), HasSubstr("outside the part's flash of 65536 bytes"));
  EXPECT_THAT(refusal(""), HasSubstr("no code"));
}

TEST_F(CortexMImage, WithABadRecordIsRefusedByLine) {
  EXPECT_THAT(refusal(":020000040800F2\n:0400000000500020FF\n", "a.hex"), HasSubstr("a.hex:2: bad checksum"));
}

TEST_F(CortexMImage, ForAnotherMachineIsRefused) {
  std::string elf = contentOf(optionsFor("hang").image);
  elf[18] = 83;
  EXPECT_THAT(refusal(elf, "avr.elf"), HasSubstr("the ELF file is not for an ARM"));
}

TEST_F(CortexMImage, ForAnUnknownPartIsRefused) {
  auto options = optionsFor("hang");
  options.mcu = "stm32f407vg";
  EXPECT_THAT(refusalOf(options), HasSubstr("stm32f407vg"));
}

TEST_F(CortexMImage, WithAnEepromIsRefused) {
  auto options = optionsFor("hang");
  options.eeprom = kBlankEeprom;
  EXPECT_THAT(refusalOf(options), HasSubstr("has no EEPROM"));
}

TEST_F(CortexMImage, BinaryAndElfRunAlike) {
  // The one segment with code of an image without initialised data.
  const std::string elf = contentOf(optionsFor("pwm").image);
  const auto field = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<std::uint8_t>(elf.at(at + i));
    return value;
  };
  const std::size_t header = field(28);
  auto options = optionsFor("pwm");
  options.image = folder_.write("pwm.bin", elf.substr(field(header + 4), field(header + 16)));
  const auto result = runWith(options, 5 * kMs);
  EXPECT_GT(result.events.size(), 100U);
  EXPECT_EQ(result.events, run("pwm", 5 * kMs).events);
}

TEST_F(CortexMImage, SourceSaysWhatARerunNeeds) {
  const auto info = openChild(optionsFor("pulses"))->info();
  EXPECT_EQ(info.rate, (TickRate{1, 72'000'000}));
  EXPECT_GT(info.stamp_err_ticks, 0U);
  EXPECT_THAT(info.config_id, AllOf(HasSubstr("Cortex-M3"), HasSubstr("stm32f103c8"), HasSubstr("HSE 8 MHz"),
                                    HasSubstr("sha256")));
}

}  // namespace
}  // namespace kerfbench::source::cortex_m
