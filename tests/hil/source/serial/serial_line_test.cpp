// SPDX-License-Identifier: Apache-2.0
#include "hil/source/serial/serial_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "tests/hil/source/serial/scripted_serial.h"
#include "tests/hil/source/words_of.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SerialLineTest : public testing::Test {
 protected:
  std::string refusal() {
    return wordsOf<SerialError>([&] { const SerialLine line(system, "/dev/ttyUSB0", 250'000); });
  }
  void TearDown() override { EXPECT_EQ(system->lines_open, 0); }
  const std::shared_ptr<ScriptedSerial> system = std::make_shared<ScriptedSerial>();
  std::vector<std::uint8_t> heard;
};

TEST_F(SerialLineTest, TakesTheLineAloneAtAnyRate) {
  {
    const SerialLine line(system, "/dev/ttyUSB0", 250'000);
    EXPECT_EQ(system->path, "/dev/ttyUSB0");
    EXPECT_EQ(system->baud, 250'000U);
    EXPECT_TRUE(system->alone);
    EXPECT_EQ(system->control_flags & CSIZE, static_cast<unsigned>(CS8));
    EXPECT_EQ(system->control_flags & (PARENB | CSTOPB | CRTSCTS), 0U);
  }
  EXPECT_FALSE(system->alone);
}

TEST_F(SerialLineTest, BytesGoBothWays) {
  SerialLine line(system, "/dev/ttyUSB0", 250'000);
  line.write(std::vector<std::uint8_t>{1, 2, 0xFF});
  system->to_bench = {9, 0, 13};
  line.pump(heard);
  EXPECT_THAT(system->from_bench, ElementsAre(1, 2, 0xFF));
  EXPECT_THAT(heard, ElementsAre(9, 0, 13));
}

TEST_F(SerialLineTest, WhatTheLineDoesNotTakeNowGoesLater) {
  SerialLine line(system, "/dev/ttyUSB0", 250'000);
  system->takes = 2;
  line.write(std::vector<std::uint8_t>{1, 2, 3});
  line.pump(heard);
  EXPECT_THAT(system->from_bench, ElementsAre(1, 2));
  system->takes = 5;
  line.pump(heard);
  EXPECT_THAT(system->from_bench, ElementsAre(1, 2, 3));
}

TEST_F(SerialLineTest, MoreThanOneReadIsTakenAtOnce) {
  SerialLine line(system, "/dev/ttyUSB0", 250'000);
  system->to_bench.assign(10'000, 7);
  line.pump(heard);
  EXPECT_EQ(heard.size(), 10'000U);
}

TEST_F(SerialLineTest, AnInterruptedCallIsNoError) {
  SerialLine line(system, "/dev/ttyUSB0", 250'000);
  system->read_error = system->write_error = EINTR;
  system->to_bench = {5};
  line.write(std::vector<std::uint8_t>{1});
  line.pump(heard);
  EXPECT_THAT(heard, ElementsAre(5));
  EXPECT_THAT(system->from_bench, ElementsAre(1));
}

TEST_F(SerialLineTest, ALineThatHangsUpIsTold) {
  SerialLine line(system, "/dev/ttyUSB0", 250'000);
  system->hung_up = true;
  EXPECT_EQ(wordsOf<SerialError>([&] { line.pump(heard); }), "/dev/ttyUSB0: the other end has hung up");
  system->read_error = EIO;
  EXPECT_THAT(wordsOf<SerialError>([&] { line.pump(heard); }), HasSubstr("hung up"));
  system->read_error = ENODEV;
  EXPECT_THAT(wordsOf<SerialError>([&] { line.pump(heard); }), HasSubstr("can no longer be read"));
  line.write(std::vector<std::uint8_t>{1});
  system->write_error = EIO;
  EXPECT_THAT(wordsOf<SerialError>([&] { line.pump(heard); }), HasSubstr("can no longer be written"));
}

TEST_F(SerialLineTest, SaysWhyALineCannotBeOpened) {
  const std::vector<std::pair<int, const char*>> cases{
      {ENOENT, "no such serial line"}, {EACCES, "dialout"},  {EPERM, "dialout"},
      {EBUSY, "another program"},      {ENODEV, "has gone"}, {ENXIO, "has gone"},
      {EMFILE, "Too many open files"}};
  for (const auto& [error, words] : cases) {
    system->open_error = error;
    EXPECT_THAT(refusal(), AllOf(HasSubstr("/dev/ttyUSB0: "), HasSubstr(words)));
  }
}

TEST_F(SerialLineTest, SaysWhyALineCannotBeSet) {
  for (const int error : {ENOTTY, EINVAL}) {
    system->get_error = error;
    EXPECT_THAT(refusal(), HasSubstr("is no serial line"));
  }
  system->get_error = EIO;
  EXPECT_THAT(refusal(), HasSubstr("does not tell its settings"));
  system->get_error = 0;
  system->exclusive_error = EPERM;
  EXPECT_THAT(refusal(), HasSubstr("cannot be had alone"));
  system->exclusive_error = 0;
  system->set_error = EINVAL;
  EXPECT_THAT(refusal(), HasSubstr("cannot be set to 250000 baud"));
  system->set_error = 0;
  system->flush_error = EIO;
  EXPECT_THAT(refusal(), HasSubstr("cannot be emptied"));
}

TEST_F(SerialLineTest, ALineThatIsRefusedIsLeftToOthers) {
  system->set_error = EINVAL;
  EXPECT_THAT(refusal(), HasSubstr("cannot be set"));
  EXPECT_FALSE(system->alone);
  system->set_error = 0;
  system->runs_at_baud = 9'600;
  EXPECT_THAT(refusal(), HasSubstr("runs at 9600 baud"));
  EXPECT_FALSE(system->alone);
}

// The call succeeds although the driver took the nearest rate that it has.
TEST_F(SerialLineTest, ARateThatTheDriverDoesNotHaveIsRefused) {
  system->runs_at_baud = 230'400;
  EXPECT_THAT(refusal(), HasSubstr("runs at 230400 baud where 250000 were asked for"));
  system->runs_at_baud = 249'000;
  EXPECT_EQ(refusal(), "no error");
}

TEST(SerialLineOnATerminalTest, TheKernelsTerminalCarriesEveryByteAsItIs) {
  int controller = -1;
  int bench = -1;
  std::string name(64, '\0');
  ASSERT_EQ(::openpty(&controller, &bench, name.data(), nullptr, nullptr), 0);
  name.resize(name.find('\0'));
  SerialLine line(linuxSerialSystem(), name, 250'000);
  ::close(bench);
  std::vector<std::uint8_t> all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  line.write(all);
  std::vector<std::uint8_t> heard;
  line.pump(heard);
  EXPECT_THAT(heard, IsEmpty());
  std::vector<std::uint8_t> seen(512);
  ASSERT_EQ(::read(controller, seen.data(), seen.size()), 256);
  seen.resize(256);
  EXPECT_EQ(seen, all);
  ASSERT_EQ(::write(controller, all.data(), all.size()), 256);
  line.pump(heard);
  EXPECT_EQ(heard, all);
  ::close(controller);
  EXPECT_THROW(line.pump(heard), SerialError);
}

TEST(SerialLineOnATerminalTest, AFileIsNoSerialLine) {
  EXPECT_THROW(SerialLine(linuxSerialSystem(), "/dev/null", 250'000), SerialError);
}

}  // namespace
}  // namespace kerfbench::source
