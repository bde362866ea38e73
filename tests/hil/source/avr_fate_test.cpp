// SPDX-License-Identifier: Apache-2.0
// Ends of a run, and images that never run.
#include <gmock/gmock.h>

#include <fstream>

#include "tests/hil/source/avr_run.h"

namespace kerfbench::source {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(AvrFate, InvalidOpcodeIsACrash) {
  const auto run = runAvr("bad_opcode", 10 * kMs);
  EXPECT_EQ(run.stop, Stop::kCrashed);
  EXPECT_THAT(run.message, AllOf(HasSubstr("crashed"), HasSubstr("opcode")));
}

TEST(AvrFate, BadWriteIsACrashAndNotADebugger) {
  const auto run = runAvr("bad_write", 10 * kMs);
  EXPECT_EQ(run.stop, Stop::kCrashed);
  EXPECT_THAT(run.message, HasSubstr("crashed"));
}

TEST(AvrFate, JumpIntoEmptyFlashIsACrash) {
  const auto run = runAvr("bad_jump", 50 * kMs);
  EXPECT_EQ(run.stop, Stop::kCrashed);
  EXPECT_THAT(run.message, HasSubstr("crashed"));
}

TEST(AvrFate, AnEndlessLoopIsJustTimeThatGoesOn) {
  const auto run = runAvr("hang", 1000 * kMs, 10 * kMs);
  EXPECT_EQ(run.stop, Stop::kReached);
  EXPECT_TRUE(run.events.empty());
}

TEST(AvrFate, SleepWithInterruptsOffIsTheEnd) {
  const auto run = runAvr("halt", 10 * kMs);
  EXPECT_EQ(run.stop, Stop::kEnded);
  EXPECT_THAT(run.message, HasSubstr("sleeps"));
}

TEST(AvrFate, AFloodOfEdgesIsStopped) {
  auto options = avrOptions("flood");
  options.max_events_per_quantum = 1000;
  const auto source = openChild(options);
  Batch batch;
  EXPECT_EQ(source->advance(10 * kMs, batch), Stop::kFlooded);
  EXPECT_EQ(batch.events.size(), 1000U);
  EXPECT_LT(batch.watermark, 10 * kMs);
  EXPECT_EQ(source->advance(20 * kMs, batch), Stop::kFlooded);
  EXPECT_TRUE(batch.events.empty());
}

class Image : public ::testing::Test {
 protected:
  std::string refusal(const std::string& content, const std::string& mcu = "atmega2560") {
    const auto path = std::filesystem::path(::testing::TempDir()) / "kerfbench-image.hex";
    std::ofstream(path, std::ios::binary) << content;
    auto options = avrOptions("hang");
    options.image = path;
    options.mcu = mcu;
    try {
      (void)openChild(options);
    } catch (const std::runtime_error& fault) {
      return fault.what();
    }
    return "accepted";
  }
};

TEST_F(Image, WithoutCodeIsRefused) { EXPECT_THAT(refusal(":00000001FF\n"), HasSubstr("no code")); }
TEST_F(Image, WithABadChecksumIsRefusedByLine) {
  EXPECT_THAT(refusal(":02000000FFCF30\n:02000200FFCF00\n:00000001FF\n"), HasSubstr("hex:2: bad checksum"));
}
TEST_F(Image, ThatIsTruncatedIsRefused) { EXPECT_THAT(refusal(":02000000FFCF30\n"), HasSubstr("truncated")); }
TEST_F(Image, ThatIsEmptyIsRefused) { EXPECT_THAT(refusal(""), HasSubstr("truncated")); }
TEST_F(Image, ThatIsNoHexIsRefused) { EXPECT_THAT(refusal("hello\n"), HasSubstr("must start with ':'")); }
TEST_F(Image, WithARecordTooShortIsRefused) { EXPECT_THAT(refusal(":0400000001\n"), HasSubstr("length")); }
TEST_F(Image, BeyondTheFlashIsRefused) {
  EXPECT_THAT(refusal(":020000040010EA\n:02000000FFCF30\n:00000001FF\n", "atmega328p"), HasSubstr("outside"));
}
TEST_F(Image, ElfThatIsTruncatedIsRefused) {
  EXPECT_THAT(refusal("\x7f"
                      "ELF\x01\x01"),
              HasSubstr("truncated"));
}
TEST_F(Image, ForAnUnknownControllerIsRefused) {
  EXPECT_THAT(refusal(":02000000FFCF30\n:00000001FF\n", "z80"), HasSubstr("z80"));
}

TEST(AvrImage, ThatIsMissingIsRefused) {
  auto options = avrOptions("hang");
  options.image = "/nonexistent/release.hex";
  EXPECT_THROW((void)openChild(options), std::runtime_error);
}

TEST(AvrImage, ElfAndHexRunAlike) {
  auto options = avrOptions("pulses");
  options.image.replace_extension(".elf");
  const auto source = openChild(options);
  EXPECT_EQ(runSource(*source, 20 * kMs, kMs).events, runAvr("pulses", 20 * kMs).events);
}

TEST(AvrImage, SourceSaysWhatARerunNeeds) {
  const auto info = openChild(avrOptions("pulses"))->info();
  EXPECT_EQ(info.rate, (TickRate{1, 16'000'000}));
  EXPECT_TRUE(info.deterministic);
  EXPECT_TRUE(info.accepts_input);
  EXPECT_THAT(info.config_id, AllOf(HasSubstr("simavr"), HasSubstr("atmega2560"),
                                    HasSubstr("own instructions"), HasSubstr("sha256")));
}

}  // namespace
}  // namespace kerfbench::source
