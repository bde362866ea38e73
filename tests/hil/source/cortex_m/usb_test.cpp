// SPDX-License-Identifier: Apache-2.0
// The serial line on USB: device, host, and whichever of USB and USART the bench is on.
#include <gmock/gmock.h>

#include <utility>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr Tick kOpen = 140 * kMs;  ///< The host has opened the line by then: 100 + 10 + 10 ms, and requests.
constexpr Tick kFrame = kMs, kMicroFrame = kFrame / 8, kBit = 6;

/// A run that says these texts at these ticks, which quanta must not divide.
struct Said {
  Tick tick{};
  std::string text;
};

Run talk(std::string_view firmware, const std::vector<Said>& said, Tick until, Tick quantum = kMs) {
  const auto source = openChild(optionsFor(firmware));
  auto next = said.begin();
  Run all;
  Batch batch;
  for (Tick tick = 0; tick < until && all.stop == Stop::kReached;) {
    for (; next != said.end() && next->tick == tick; ++next)
      source->uartWrite({reinterpret_cast<const std::uint8_t*>(next->text.data()), next->text.size()});
    Tick end = std::min(until, tick + quantum);
    if (next != said.end()) end = std::min(end, next->tick);
    tick = end;
    all.stop = source->advance(tick, batch);
    all.events.insert(all.events.end(), batch.events.begin(), batch.events.end());
    all.uart.append(batch.uart.begin(), batch.uart.end());
  }
  all.message = source->message();
  return all;
}

std::string answerTo(std::string_view firmware, const std::string& text) {
  return talk(firmware, {{kOpen, text}}, kOpen + 20 * kMs).uart;
}

/// Lines of a length, each another.
std::string linesOfLength(std::size_t bytes, std::size_t lines) {
  std::string text;
  for (std::size_t i = 0; i < lines; ++i)
    text += std::string(bytes - 1, static_cast<char>('a' + i % 26)) + "\n";
  return text;
}

/// Edges of PA0 either way: a line each.
std::vector<Tick> linesAt(const Run& run) {
  std::vector<Tick> ticks;
  for (const PinEvent& event : run.events) ticks.push_back(event.tick);
  return ticks;
}

using CortexMUsb = CortexM;

TEST_F(CortexMUsb, RegistersToggleClearAndKeepAsTheManualSays) {
  EXPECT_THAT(linesOf(run("usb_registers", 20 * kMs).uart),
              ElementsAre("3", "0",                    // out of a reset; nothing stays under one
                          "13875", "1555", "18003",    // 0x3633, 0x0613, 0x4653
                          "22136", "43981", "65528",   // 0x5678, 0xABCD, 0xFFF8
                          "1024", "0", "1024", "0"));  // the reset is told until it is cleared
}

TEST_F(CortexMUsb, HostOpensTheLineAsTheScenarioSetsIt) {
  // Rate, bits, DTR and RTS; the bus was idle before the host's reset, and woke the device by it.
  EXPECT_EQ(answerTo("usb_echo", "?\n"), "?\n250000 8 3 1 1 \n");
}

TEST_F(CortexMUsb, PinsOfTheBusAreNotThePorts) {
  for (const PinEvent& event : talk("usb_echo", {{kOpen, "a\n"}}, kOpen + 5 * kMs).events)
    EXPECT_EQ(event.changed, 1U);
}

TEST_F(CortexMUsb, BytesOfAllLengthsComeBack) {
  for (const std::size_t bytes : {1U, 63U, 64U, 65U, 127U, 128U, 129U, 300U}) {
    const std::string text = linesOfLength(bytes, 1);
    EXPECT_EQ(answerTo("usb_echo", text), text) << bytes;
  }
}

TEST_F(CortexMUsb, ADeviceWithoutRoomHoldsTheHostOff) {
  const std::string text = linesOfLength(50, 100);
  const auto result = talk("usb_echo", {{kOpen, text}}, kOpen + 30 * kMs);
  EXPECT_EQ(result.uart, text);
  EXPECT_THAT(result.events, SizeIs(100));
}

TEST_F(CortexMUsb, PacketsTakeTheirTimeOnTheBus) {
  constexpr Tick kPacket = (35 + 7 + 35 + 8 * 64 + 7 + 19) * kBit;
  const auto result = talk("usb_echo", {{kOpen, linesOfLength(64, 8)}}, kOpen + 20 * kMs);
  const auto at = linesAt(result);
  ASSERT_THAT(at, SizeIs(8));
  EXPECT_GT(at[0], kOpen + kPacket);
  EXPECT_LT(at[0], kOpen + kMicroFrame + kPacket + kMicroFrame);
  for (const Tick step : steps(at)) EXPECT_GE(step, kPacket);
  // A frame has room for 19 such packets (USB 2.0, table 5-9); here both ways share it.
  EXPECT_LT(at[7] - at[0], kFrame);
}

TEST_F(CortexMUsb, StampsDoNotDependOnQuanta) {
  const std::vector<Said> said{{kOpen, linesOfLength(64, 3)},
                               {kOpen + 7 * kMs + 12'345, "?\nabc\n"},
                               {kOpen + 9 * kMs + 1, linesOfLength(20, 40)}};
  const auto once = talk("usb_echo", said, kOpen + 30 * kMs, 500 * kMs);
  EXPECT_THAT(once.events, SizeIs(45));
  for (const Tick quantum : {Tick{7'001}, Tick{36'000}, 5 * kMs}) {
    const auto again = talk("usb_echo", said, kOpen + 30 * kMs, quantum);
    EXPECT_EQ(again.events, once.events) << quantum;
    EXPECT_EQ(again.uart, once.uart) << quantum;
  }
}

TEST_F(CortexMUsb, AHaltedEndpointIsClearedAndGoesOn) {
  EXPECT_EQ(talk("usb_echo", {{kOpen, "!\n"}, {kOpen + 10 * kMs, "b\n"}}, kOpen + 20 * kMs).uart, "!\nb\n");
}

TEST_F(CortexMUsb, AFullPacketWithoutAnEndWaitsForTheNext) {
  const std::string line = linesOfLength(64, 1);
  const auto result = talk("usb_no_end", {{kOpen, line}, {kOpen + 10 * kMs, "b\n"}}, kOpen + 20 * kMs, kMs);
  EXPECT_EQ(result.uart, line + "b\n");
  EXPECT_EQ(talk("usb_no_end", {{kOpen, line}}, kOpen + 20 * kMs).uart, "");
}

TEST_F(CortexMUsb, ALineWithoutARateIsALine) { EXPECT_EQ(answerTo("usb_no_rate", "a\n"), "a\n"); }

void expectMisheard(std::string_view firmware, const std::string& text, const std::string& words) {
  const auto result = talk(firmware, {{kOpen, text}}, 700 * kMs, 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kMisheard) << firmware << ": " << result.message;
  EXPECT_THAT(result.message, HasSubstr(words));
}

TEST_F(CortexMUsb, ARequestThatIsRefusedIsNamed) {
  expectMisheard("usb_stalled", "", "the firmware's USB device answers SET_CONFIGURATION with a STALL");
}

TEST_F(CortexMUsb, ARequestWithoutAnAnswerIsNamed) {
  expectMisheard("usb_silent", "", "does not answer GET_DESCRIPTOR of the device, 8 bytes, for 500 ms");
  expectMisheard("usb_put_off", "", "puts off (NAK) GET_DESCRIPTOR of the device, 8 bytes, for 500 ms");
}

TEST_F(CortexMUsb, AnotherDeviceIsNoLine) {
  expectMisheard("usb_vendor", "a\n", "has no serial line (CDC-ACM): its interfaces are of class ff, ff");
  // One that the bench has nothing to say to may be right.
  EXPECT_EQ(run("usb_vendor", kOpen + 60 * kMs).stop, Stop::kReached);
}

TEST_F(CortexMUsb, AnotherClockThan48MHzIsMisheard) {
  expectMisheard("usb_clock", "", "runs its USB at 72000000 Hz from the PLL");
}

TEST_F(CortexMUsb, ABufferOutsideThePacketMemoryEndsTheRun) {
  const auto result = talk("usb_outside", {{kOpen, linesOfLength(20, 1)}}, kOpen + 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kCrashed);
  EXPECT_THAT(result.message, HasSubstr("a USB buffer of endpoint register 1 has 20 bytes from 0x1f0 on, and "
                                        "the packet memory ends at 0x200"));
}

TEST_F(CortexMUsb, APacketLargerThanItsBufferIsRefused) {
  EXPECT_EQ(answerTo("usb_small_buffer", linesOfLength(32, 1)), linesOfLength(32, 1));
  expectMisheard("usb_small_buffer", linesOfLength(33, 1),
                 "endpoint 1 (OUT) of the firmware's USB device answers with a STALL again and again");
}

TEST_F(CortexMUsb, WhatIsNotModelledEndsTheRunByName) {
  const auto result = run("usb_double", kOpen);
  EXPECT_EQ(result.stop, Stop::kCrashed);
  EXPECT_THAT(result.message,
              HasSubstr("sets the double buffer of USB endpoint register 1, which is not modelled"));
}

TEST_F(CortexMUsb, ADeviceThatComesBackIsOpenedAgain) {
  const auto result = talk("usb_leaves", {{kOpen, "r\n"}, {kOpen + 200 * kMs, "a\n"}}, kOpen + 210 * kMs);
  EXPECT_EQ(result.uart, "r\na\n");
}

TEST_F(CortexMUsb, ADeviceThatStaysAwayIsSaidWhenItIsTalkedTo) {
  const std::vector<Said> said{{kOpen, "g\n"}, {kOpen + 1100 * kMs, "a\n"}};
  const auto result = talk("usb_leaves", said, kOpen + 1200 * kMs, 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kMisheard);
  EXPECT_EQ(result.uart, "g\n");
  EXPECT_THAT(result.message, HasSubstr("has taken its USB device off the bus, and it has not come back"));
}

TEST_F(CortexMUsb, TheLineIsOnUsbWhereAUsartSpeaksAsWell) {
  EXPECT_EQ(answerTo("usb_and_usart", "a\n"), "a\n");
}

TEST_F(CortexMUsb, TheLineIsOnTheUsartWhereTheUsbIsNone) {
  EXPECT_EQ(answerTo("usb_vendor_and_usart", "a\n"), "a\n");
}

}  // namespace
}  // namespace kerfbench::source::cortex_m
