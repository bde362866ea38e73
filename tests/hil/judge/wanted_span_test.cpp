// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/wanted_span.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace kerfbench::judge {
namespace {

constexpr PinId kGate{2, 5};
const evidence::ActiveLine kGateLine(kGate, false);
constexpr double kMargin_s = 0.05;
constexpr double kLag_s = 0.0003;
constexpr TickRate kMicroseconds{1, 1'000'000};

PinEvent gate(Tick tick, bool open) {
  return {tick, kGate.port, 1U << 5U, static_cast<std::uint16_t>(open ? 1U << 5U : 0U), 0};
}

TEST(WantedSpan, IsEmptyBeforeTheGateIsOpenedAndMovesOn) {
  WantedSpan wanted(kGateLine, kMicroseconds, kMargin_s, kLag_s);
  wanted.add({}, 200'000);
  EXPECT_DOUBLE_EQ(wanted.soFar().from_s, 0.15);
  EXPECT_LT(wanted.soFar().to_s, wanted.soFar().from_s);
  EXPECT_FALSE(wanted.inAll());
}

TEST(WantedSpan, AGateThatIsOpenWhileLowIsWantedThen) {
  WantedSpan wanted({kGate, true}, kMicroseconds, kMargin_s, kLag_s);
  const std::vector<PinEvent> events{gate(10, true), gate(300'000, false), gate(400'000, true)};
  wanted.add(events, 1'000'000);
  ASSERT_TRUE(wanted.inAll());
  EXPECT_DOUBLE_EQ(wanted.inAll()->from_s, 0.3 - kMargin_s);
  EXPECT_DOUBLE_EQ(wanted.inAll()->to_s, 0.4 + kMargin_s);
}

TEST(WantedSpan, OtherPinsDoNotMatter) {
  WantedSpan wanted(kGateLine, kMicroseconds, kMargin_s, kLag_s);
  const std::vector<PinEvent> events{{10, 1, 1U << 5U, 1U << 5U, 0}, {20, 2, 1, 1, 0}};
  wanted.add(events, 100);
  EXPECT_FALSE(wanted.inAll());
}

TEST(WantedSpan, AGateThatStaysOpenIsWantedUpToTheEnd) {
  WantedSpan wanted(kGateLine, kMicroseconds, kMargin_s, kLag_s);
  const std::vector<PinEvent> events{gate(100'000, true)};
  wanted.add(events, 150'000);
  EXPECT_DOUBLE_EQ(wanted.soFar().to_s, 0.15 - kLag_s);
  EXPECT_DOUBLE_EQ(wanted.inAll()->from_s, 0.05);
  EXPECT_DOUBLE_EQ(wanted.inAll()->to_s, 0.2);
}

/// Whatever was said to be wanted while the run went on is wanted in the end, nothing of it was dropped
/// before, and neither time went back.
TEST(WantedSpan, WhatIsSaidMeanwhileHoldsInTheEnd) {
  std::mt19937 random(7);
  for (int run = 0; run < 200; ++run) {
    WantedSpan wanted(kGateLine, kMicroseconds, kMargin_s, kLag_s);
    bool open = false;
    double first_s = -1.0, last_s = -1.0;
    double dropped_before_s = -std::numeric_limits<double>::infinity();
    double said_to_s = -std::numeric_limits<double>::infinity();
    Tick now = 0;
    for (int quantum = 0; quantum < 100; ++quantum) {
      std::vector<PinEvent> events;
      const Tick until = now + 1 + random() % 40'000;
      for (Tick tick = now + 1 + random() % 60'000; tick <= until; tick += 1 + random() % 20'000) {
        open = !open;
        events.push_back(gate(tick, open));
        if (first_s < 0) first_s = kMicroseconds.seconds(tick);
        if (!open) last_s = kMicroseconds.seconds(tick);
      }
      now = until;
      wanted.add(events, now);
      const inspect::Span span = wanted.soFar();
      EXPECT_GE(span.from_s, dropped_before_s);
      EXPECT_GE(span.to_s, said_to_s);
      EXPECT_LE(span.to_s, kMicroseconds.seconds(now) - kLag_s);
      dropped_before_s = span.from_s;
      said_to_s = span.to_s;
    }
    if (open) last_s = kMicroseconds.seconds(now);
    ASSERT_TRUE(wanted.inAll());
    EXPECT_DOUBLE_EQ(wanted.inAll()->from_s, first_s - kMargin_s);
    EXPECT_DOUBLE_EQ(wanted.inAll()->to_s, last_s + kMargin_s);
    EXPECT_LE(dropped_before_s, wanted.inAll()->from_s);
    EXPECT_LE(said_to_s, wanted.inAll()->to_s);
  }
}

}  // namespace
}  // namespace kerfbench::judge
