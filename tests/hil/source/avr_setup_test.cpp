// SPDX-License-Identifier: Apache-2.0
// What a scenario says of an AVR beside its image: the rate of its UART, and what its EEPROM holds.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/avr_run.h"

namespace kerfbench::source {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

kerfbench::source::Run runAt(std::string_view firmware, std::uint64_t clock_hz, std::uint32_t baud) {
  ChildSourceOptions options = avrOptions(firmware);
  options.clock_hz = clock_hz;
  options.baud = baud;
  const auto source = openChild(options);
  return runSource(*source, 200 * kMs, kMs / 2);
}

// line_ok.c sets its UART for 111 111 baud at 16 MHz.
TEST(AvrUart, ARateThatAReceiverForgivesIsHeard) {
  for (const std::uint32_t baud : {106'000U, 111'111U, 115'200U, 117'000U}) {
    const auto run = runAt("line_ok", 16'000'000, baud);
    EXPECT_EQ(run.stop, Stop::kReached) << run.message;
    EXPECT_THAT(run.uart, HasSubstr("TinyGrbl"));
  }
}

TEST(AvrUart, AnotherRateEndsTheRunAndIsNamed) {
  for (const std::uint32_t baud : {9600U, 104'000U, 118'500U, 250'000U}) {
    const auto run = runAt("line_ok", 16'000'000, baud);
    EXPECT_EQ(run.stop, Stop::kMisheard) << baud;
    EXPECT_THAT(run.message, HasSubstr("runs at 111111 baud"));
    EXPECT_THAT(run.message, HasSubstr(std::to_string(baud)));
    EXPECT_EQ(run.uart, "");
  }
}

TEST(AvrUart, AWrongClockIsAWrongRate) {
  const auto run = runAt("line_ok", 8'000'000, 115'200);
  EXPECT_EQ(run.stop, Stop::kMisheard);
  EXPECT_THAT(run.message, HasSubstr("runs at 55556 baud, with a clock of 8000000 Hz"));
}

TEST(AvrUart, WhatTheFirmwareHearsIsWatchedAsWell) {
  // echo.c says nothing by itself.
  ChildSourceOptions options = avrOptions("echo");
  options.baud = 57'600;
  const auto source = openChild(options);
  auto run = runSource(*source, 5 * kMs, kMs / 2);
  EXPECT_EQ(run.stop, Stop::kReached) << run.message;
  source->uartWrite(std::vector<std::uint8_t>{'?'});
  Batch batch;
  for (Tick tick = 6 * kMs; tick < 20 * kMs && run.stop == Stop::kReached; tick += kMs)
    run.stop = source->advance(tick, batch);
  EXPECT_EQ(run.stop, Stop::kMisheard);
  EXPECT_THAT(source->message(), HasSubstr("the bench at 57600"));
}

TEST(AvrUart, AFrameOfSevenBitsIsNamed) {
  const auto run = runAt("seven_bits", 16'000'000, 250'000);
  EXPECT_EQ(run.stop, Stop::kMisheard);
  EXPECT_THAT(run.message, HasSubstr("takes 9 bits, and the bench has 10 (8N1)"));
}

// What is not spoken is not held against anybody: a firmware's UART may have any rate and frame.
TEST(AvrUart, WhereNobodyListensItMayRunAsItLikes) {
  const auto run = runAt("line_ok", 16'000'000, 0);
  EXPECT_EQ(run.stop, Stop::kReached) << run.message;
  EXPECT_EQ(run.uart, runAt("line_ok", 16'000'000, 111'111).uart);
  EXPECT_EQ(runAt("seven_bits", 16'000'000, 0).stop, Stop::kReached);
}

TEST(AvrUart, WithoutARateNothingIsSent) {
  ChildSourceOptions options = avrOptions("echo");
  options.baud = 0;
  const auto source = openChild(options);
  source->uartWrite(std::vector<std::uint8_t>{'?'});
  Batch batch;
  EXPECT_EQ(source->advance(kMs, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), HasSubstr("baud 0"));
}

class AvrEeprom : public ::testing::Test {
 protected:
  [[nodiscard]] static std::string read(const std::string& eeprom, const std::filesystem::path& image = {}) {
    ChildSourceOptions options = avrOptions("eeprom");
    options.eeprom = eeprom;
    if (!image.empty()) options.image = image;
    const auto source = openChild(options);
    const auto run = runSource(*source, 5 * kMs, kMs / 2);
    EXPECT_EQ(run.stop, Stop::kReached) << run.message;
    return run.uart;
  }
  /// The image with four bytes more, at the linker's address of the EEPROM.
  [[nodiscard]] std::filesystem::path imageWithEeprom() const {
    std::ifstream file(avrOptions("eeprom").image);
    std::stringstream text;
    text << file.rdbuf();
    std::string hex = text.str();
    hex.insert(hex.find(":00000001FF"),
               ":020000040081"
               "79\n"
               ":0400000011223344"
               "52\n");
    return folder_.write("with-eeprom.hex", hex);
  }
  base::TempFolder folder_;
};

TEST_F(AvrEeprom, IsErasedWhereNobodySaysOtherwise) { EXPECT_EQ(read(""), "ffffffffff"); }

TEST_F(AvrEeprom, HoldsWhatTheImageSays) { EXPECT_EQ(read("", imageWithEeprom()), "11223344ff"); }

TEST_F(AvrEeprom, IsErasedOnDemand) { EXPECT_EQ(read("blank", imageWithEeprom()), "ffffffffff"); }

TEST_F(AvrEeprom, HoldsTheBytesOfAFile) {
  const auto file = folder_.write("settings.bin", std::string("\x01\x00\x80", 3));
  EXPECT_EQ(read(file.string(), imageWithEeprom()), "010080ffff");
}

TEST_F(AvrEeprom, HoldsAnIntelHexFileFromAddressZeroOrTheLinkersAddress) {
  EXPECT_EQ(read(folder_.write("zero.eep", ":020001000A0BE8\n:00000001FF\n").string()), "ff0a0bffff");
  EXPECT_EQ(read(folder_.write("linker.hex", ":02000004008179\n:020000000A0BE9\n:00000001FF\n").string()),
            "0a0bffffff");
}

TEST_F(AvrEeprom, AFileThatDoesNotFitIsRefusedByName) {
  const auto opening = [&](const std::string& file) { return [file] { (void)read(file); }; };
  EXPECT_THAT(opening(folder_.write("large.bin", std::string(4097, 'x')).string()),
              ThrowsMessage<std::runtime_error>(
                  testing::AllOf(HasSubstr("large.bin"), HasSubstr("outside the controller's memory"))));
  EXPECT_THAT(opening(folder_.write("bad.eep", ":020001000A0BE7\n:00000001FF\n").string()),
              ThrowsMessage<std::runtime_error>(HasSubstr("bad.eep:1: bad checksum")));
  EXPECT_THAT(opening(folder_.write("empty.bin", "").string()),
              ThrowsMessage<std::runtime_error>(HasSubstr("empty.bin: the file holds nothing")));
  EXPECT_THAT(opening((folder_.path() / "none.bin").string()),
              ThrowsMessage<std::runtime_error>(HasSubstr("none.bin: No such file")));
}

TEST_F(AvrEeprom, FillsAllOfIt) {
  std::string bytes(4096, '\0');
  bytes.back() = '\x5a';
  EXPECT_EQ(read(folder_.write("full.bin", bytes).string()), "000000005a");
}

}  // namespace
}  // namespace kerfbench::source
