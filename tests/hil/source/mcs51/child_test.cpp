// SPDX-License-Identifier: Apache-2.0
// kerfbench-mcs51 as the bench starts it: pulses, bytes, ends of a run, and images that never run.
#include <gmock/gmock.h>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/mcs51/oracle.h"
#include "tests/hil/source/mcs51/program.h"
#include "tests/hil/source/run_source.h"

namespace kerfbench::mcs51_child {
namespace {

using source::Batch;
using source::ChildSourceOptions;
using source::edgesOf;
using source::openChild;
using source::runSource;
using source::Stop;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

constexpr std::uint64_t kClock_hz = 11'059'200;
constexpr Tick kMs51 = kClock_hz / 1000;
constexpr PinId kStep{1, 0};

class Mcs51Child : public ::testing::Test {
 protected:
  [[nodiscard]] ChildSourceOptions options(const Program& program, const char* mcu = "at89s52") const {
    ChildSourceOptions made;
    made.child = KERFBENCH_MCS51_CHILD;
    made.image = folder_.write("image.hex", intelHex(program.code()));
    made.mcu = mcu;
    made.clock_hz = kClock_hz;
    made.baud = 9600;
    return made;
  }
  [[nodiscard]] source::Run run(const Program& program, Tick until, Tick quantum = kMs51) const {
    const auto source = openChild(options(program));
    return runSource(*source, until, quantum);
  }
  [[nodiscard]] std::string refusal(const ChildSourceOptions& asked) const {
    try {
      (void)openChild(asked);
    } catch (const std::runtime_error& fault) {
      return fault.what();
    }
    return "accepted";
  }
  base::TempFolder folder_;
};

/// Timer 0 makes 500 pulses of five cycles on P1.0 with 200 cycles between two, DIR on P1.1 before them.
Program pulses() {
  Program p;
  p.ljmp(0x40).at(0x0B).ljmp(0x20).at(0x20);
  p.setb(kP1_0).nop(4).clr(kP1_0).djnzR(6, 0x30).djnzR(7, 0x30).mov(kIe, 0).at(0x30).reti();
  p.at(0x40).mov(kP1, 0xFE).clr(kP1_1).put({0x7E, 0xF4, 0x7F, 0x02});  // 500 as DJNZ counts it
  p.mov(kTmod, 0x02).mov(kTl0, 56).mov(kTh0, 56).mov(kIe, 0x82).setb(kTr0).halt();
  return p;
}

TEST_F(Mcs51Child, PulsesAreExactInNumberAndPeriod) {
  const auto made = run(pulses(), 120'000 * 12);
  EXPECT_EQ(made.stop, Stop::kReached) << made.message;
  const auto rises = edgesOf(made.events, kStep);
  const auto falls = edgesOf(made.events, kStep, false);
  ASSERT_EQ(rises.size(), 501U);  // The first one is that of the reset.
  ASSERT_EQ(falls.size(), 501U);
  for (std::size_t i = 2; i < rises.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(rises[i] - rises[i - 1]), 12.0 * 200, 12.0);
    EXPECT_EQ(falls[i] - rises[i], 12U * 5);
  }
  EXPECT_NEAR(static_cast<double>(rises.back() - rises[1]) / 499, 12.0 * 200, 0.1);
}

TEST_F(Mcs51Child, PulsesAreTheSameForEveryQuantum) {
  const auto reference = run(pulses(), 6'000 * 12);
  for (const Tick quantum : {Tick{7}, Tick{333}, kMs51 / 2, Tick{480'000}})
    EXPECT_EQ(run(pulses(), 6'000 * 12, quantum).events, reference.events) << quantum;
}

/// Answers each byte with its successor. 9600 baud at 11.0592 MHz.
Program echo(unsigned reload = 0xFD, unsigned scon = 0x50) {
  Program p;
  p.ljmp(0x40).at(0x23).ljmp(0x60).at(0x40);
  p.mov(kTmod, 0x20).mov(kTh1, reload).mov(kTl1, reload).mov(kScon, scon).setb(kTr1).mov(kIe, 0x90).halt();
  p.at(0x60).put({0x10, kRiBit, 0x03}).clr(kTiBit).reti();  // JBC RI,+3
  p.cpl(kP1_0).put({0xE5, kSbuf, 0x04, 0xF5, kSbuf}).reti();
  return p;
}

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST_F(Mcs51Child, EchoComesBackAtTenBitTimesPerByte) {
  const auto source = openChild(options(echo()));
  std::string text;
  for (int i = 0; i < 100; ++i) text += static_cast<char>('!' + i % 90);
  std::string expected = text;
  for (auto& c : expected) ++c;
  const auto made = runSource(*source, 120 * kMs51, kMs51, [&](Tick tick) {
    if (tick == 2 * kMs51) source->uartWrite(bytesOf(text));
  });
  EXPECT_EQ(made.uart, expected);
}

TEST_F(Mcs51Child, AnotherRateEndsTheRunAndIsNamed) {
  auto asked = options(echo());
  asked.baud = 19'200;
  const auto source = openChild(asked);
  const auto made = runSource(*source, 20 * kMs51, kMs51, [&](Tick tick) {
    if (tick == 2 * kMs51) source->uartWrite(bytesOf("?"));
  });
  EXPECT_EQ(made.stop, Stop::kMisheard);
  EXPECT_THAT(made.message,
              AllOf(HasSubstr("runs at 9600 baud, with a clock of 11059200 Hz"), HasSubstr("19200")));
}

TEST_F(Mcs51Child, ANinthBitThatIsNoStopBitIsNamed) {
  Program p;
  p.mov(kTmod, 0x20).mov(kTh1, 0xFD).mov(kTl1, 0xFD).mov(kScon, 0xC0).setb(kTr1).mov(kSbuf, 0x41).halt();
  const auto made = run(p, 20 * kMs51);
  EXPECT_EQ(made.stop, Stop::kMisheard);
  EXPECT_THAT(made.message, HasSubstr("11 bits"));
  Program second_stop_bit;
  second_stop_bit.mov(kTmod, 0x20)
      .mov(kTh1, 0xFD)
      .mov(kTl1, 0xFD)
      .mov(kScon, 0xC8)
      .setb(kTr1)
      .mov(kSbuf, 0x41);
  second_stop_bit.halt();
  EXPECT_EQ(run(second_stop_bit, 20 * kMs51).uart, "A");
}

TEST_F(Mcs51Child, BytesWithoutAPauseAreMisheardByAReceiverOfElevenBits) {
  const auto source = openChild(options(echo(0xFD, 0xD8)));
  const auto made = runSource(*source, 20 * kMs51, kMs51, [&](Tick tick) {
    if (tick == 2 * kMs51) source->uartWrite(bytesOf("ab"));
  });
  EXPECT_EQ(made.stop, Stop::kMisheard);
  EXPECT_THAT(made.message, HasSubstr("listens for bytes of 11 bits"));
}

TEST_F(Mcs51Child, WhereNobodyListensTheUartMayRunAsItLikes) {
  Program p;
  p.mov(kTmod, 0x20).mov(kTh1, 0xFD).mov(kTl1, 0xFD).mov(kScon, 0xC0).setb(kTr1).mov(kSbuf, 0x41).halt();
  auto asked = options(p);
  asked.baud = 0;
  const auto made = runSource(*openChild(asked), 20 * kMs51, kMs51);
  EXPECT_EQ(made.stop, Stop::kReached) << made.message;
  EXPECT_EQ(made.uart, "A");
}

/// P1.0 follows P3.3, which is written to again and again; INT0 inverts P1.2.
Program follower() {
  Program p;
  p.ljmp(0x40).at(0x03).cpl(kP1_2).reti().at(0x40).setb(kIt0).mov(kIe, 0x81);
  const unsigned loop = p.here();
  p.put({0x43, kP3, 0x08, 0xA2, 0xB3, 0x92, kP1_0}).sjmp(loop);  // ORL P3,#8; MOV C,P3.3; MOV P1.0,C
  return p;
}

TEST_F(Mcs51Child, DrivenInputStaysWhenTheFirmwareWritesToItsPort) {
  const auto source = openChild(options(follower()));
  source->drive({3, 3}, false, 1);
  source->drive({3, 3}, true, 5 * kMs51);
  source->drive({3, 3}, false, 7 * kMs51);
  const auto made = runSource(*source, 10 * kMs51, kMs51);
  const auto rises = edgesOf(made.events, kStep, true);
  const auto falls = edgesOf(made.events, kStep, false);
  ASSERT_EQ(rises.size(), 2U);
  ASSERT_EQ(falls.size(), 2U);
  // The loop has seven cycles.
  EXPECT_NEAR(static_cast<double>(rises[1]), 5.0 * kMs51 + 60, 60);
  EXPECT_NEAR(static_cast<double>(falls[1]), 7.0 * kMs51 + 60, 60);
}

TEST_F(Mcs51Child, RunsWithInputsRepeatToTheTickForEveryQuantum) {
  const auto made = [&](Tick quantum) {
    const auto source = openChild(options(follower()));
    for (Tick tick = 2000; tick < 4 * kMs51; tick += 37) {
      source->drive({3, 2}, (tick * 7919 >> 5 & 1) != 0, tick);
      source->drive({3, 3}, (tick * 104729 >> 6 & 1) != 0, tick + tick % 30);
    }
    return runSource(*source, 5 * kMs51, quantum).events;
  };
  const auto reference = made(kMs51 / 10);
  EXPECT_GT(reference.size(), 300U);
  for (const Tick quantum : {Tick{5}, Tick{13}, kMs51, 5 * kMs51})
    EXPECT_EQ(made(quantum), reference) << quantum;
}

TEST_F(Mcs51Child, APinThatTheControllerLacksEndsTheRunInWords) {
  const auto source = openChild(options(follower()));
  source->drive({4, 0}, true, 10);
  Batch batch;
  EXPECT_EQ(source->advance(kMs51, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), HasSubstr("no pin P4.0"));
}

// The bench reads answers to quanta that were asked for together, and they are those to single ones.
TEST_F(Mcs51Child, WhatIsForeseenMayBeAskedForAtOnce) {
  const Tick quantum = kMs51 / 2;
  const auto runOnce = [&](bool is_foreseen) {
    const auto source = openChild(options(follower()));
    const Tick press = 40 * quantum + 7;
    return runSource(*source, 100 * quantum, quantum, [&](Tick until) {
      if (until == 41 * quantum) source->drive({3, 3}, false, press);
      if (is_foreseen) source->foresee(quantum, (until <= 40 * quantum ? 40 : 100) * quantum);
    });
  };
  const auto in_turns = runOnce(false);
  const auto ahead = runOnce(true);
  EXPECT_EQ(ahead.stop, Stop::kReached) << ahead.message;
  EXPECT_EQ(ahead.events, in_turns.events);
  EXPECT_EQ(edgesOf(ahead.events, {1, 0}, false).size(), 1U);
}

TEST_F(Mcs51Child, InputsForAForeseenTimeAreRefused) {
  const auto source = openChild(options(follower()));
  source->foresee(kMs51, 5 * kMs51);
  Batch batch;
  EXPECT_EQ(source->advance(kMs51, batch), Stop::kReached);
  EXPECT_THROW(source->drive({3, 3}, false, 5 * kMs51), std::invalid_argument);
  EXPECT_THROW(source->uartWrite(bytesOf("?")), std::invalid_argument);
  EXPECT_THROW(source->advance(kMs51 + 1, batch), std::invalid_argument);
  source->drive({3, 3}, false, 5 * kMs51 + 1);
  for (Tick until = 2 * kMs51; until <= 6 * kMs51; until += kMs51)
    EXPECT_EQ(source->advance(until, batch), Stop::kReached);
  EXPECT_EQ(edgesOf(batch.events, {1, 0}, false).size(), 1U);
}

// A crash amid quanta that were asked for together ends the run where it is.
TEST_F(Mcs51Child, ARunAheadEndsWhereTheFirmwareDoes) {
  Program p;
  p.put({0x78, 0x04, 0x79, 0x00}).djnzR(1, 4).djnzR(0, 4).put({0xA5});  // R0 turns of 256 by two cycles
  const auto source = openChild(options(p));
  source->foresee(1000, 100'000);
  const auto ahead = runSource(*source, 100'000, 1000);
  const auto in_turns = run(p, 100'000, 1000);
  EXPECT_EQ(ahead.stop, Stop::kCrashed);
  EXPECT_EQ(ahead.message, in_turns.message);
  EXPECT_EQ(ahead.events, in_turns.events);
}

TEST_F(Mcs51Child, AFloodOfEdgesIsStopped) {
  Program p;
  p.cpl(kP1_0).sjmp(0);
  auto asked = options(p);
  asked.max_events_per_quantum = 1000;
  const auto source = openChild(asked);
  Batch batch;
  EXPECT_EQ(source->advance(10 * kMs51, batch), Stop::kFlooded);
  EXPECT_EQ(batch.events.size(), 1000U);
  EXPECT_LT(batch.watermark, 10 * kMs51);
}

TEST_F(Mcs51Child, EndsOfARunAreNamed) {
  const auto crashed = run(Program().nop(3).put({0xA5}), 10 * kMs51);
  EXPECT_EQ(crashed.stop, Stop::kCrashed);
  EXPECT_THAT(crashed.message, AllOf(HasSubstr("crashed"), HasSubstr("opcode 0xa5 at address 0x0003")));
  const auto ended = run(Program().mov(kPcon, 1).halt(), 10 * kMs51);
  EXPECT_EQ(ended.stop, Stop::kEnded);
  EXPECT_THAT(ended.message, HasSubstr("idles"));
  const auto hung = run(Program().halt(), 1000 * kMs51, 10 * kMs51);
  EXPECT_EQ(hung.stop, Stop::kReached);
  EXPECT_EQ(hung.events.size(), 4U);  // A reset has four.
}

TEST_F(Mcs51Child, ImagesThatDoNotFitAreRefusedInWords) {
  auto asked = options(Program().halt());
  asked.mcu = "at89c51";
  EXPECT_EQ(refusal(asked), "accepted");
  asked.eeprom = "blank";
  EXPECT_THAT(refusal(asked), HasSubstr("no EEPROM"));
  asked.eeprom.clear();
  asked.mcu = "z80";
  EXPECT_THAT(refusal(asked), HasSubstr("z80"));
  asked.mcu = "at89c51";
  asked.image = folder_.write("large.hex", intelHex(Program().at(0x1000).halt().code()));
  EXPECT_THAT(refusal(asked), AllOf(HasSubstr("large.hex:"), HasSubstr("outside the controller's memory")));
  asked.image = folder_.write("empty.hex", ":00000001FF\n");
  EXPECT_THAT(refusal(asked), HasSubstr("no code"));
  asked.image = folder_.write("bad.hex", ":0200000080FE81\n:00000001FF\n");
  EXPECT_THAT(refusal(asked), HasSubstr("bad.hex:1: bad checksum"));
}

// The release by SDCC: HELLO is answered by ACK and by INFO, which names the release (protocol.h).
TEST_F(Mcs51Child, TheReferenceControllerSaysWhatItIs) {
  ChildSourceOptions asked;
  asked.child = KERFBENCH_MCS51_CHILD;
  asked.image = KERFBENCH_MCS51_RELEASE;
  asked.mcu = "stc15w4k32s4";
  asked.clock_hz = 24'000'000;
  asked.baud = 125'000;
  if (!std::filesystem::exists(asked.image)) GTEST_SKIP() << "no release for an 8051: sdcc is not installed";
  const auto source = openChild(asked);
  const auto made = runSource(*source, 960'000, 24'000, [&](Tick tick) {
    if (tick == 240'000) source->uartWrite(bytesOf(std::string("\xA5\x01\x00\x00\xAC\xFB", 6)));
  });
  EXPECT_EQ(made.stop, Stop::kReached) << made.message;
  EXPECT_THAT(made.uart, AllOf(HasSubstr("\xA5"), HasSubstr("KERFREL"), HasSubstr("mcs51")));
  // The outputs of the laser are never high.
  for (const auto& event : made.events) {
    if (event.port == 2) EXPECT_EQ(event.level & 0x0C, 0);
  }
}

TEST_F(Mcs51Child, SourceSaysWhatARerunNeeds) {
  const auto info = openChild(options(pulses()))->info();
  EXPECT_EQ(info.rate, (TickRate{1, kClock_hz}));
  EXPECT_TRUE(info.deterministic);
  EXPECT_TRUE(info.accepts_input);
  EXPECT_THAT(info.config_id, AllOf(HasSubstr("kerfbench-mcs51"), HasSubstr("at89s52"),
                                    HasSubstr("12 clocks"), HasSubstr("sha256")));
}

}  // namespace
}  // namespace kerfbench::mcs51_child
