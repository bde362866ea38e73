// SPDX-License-Identifier: Apache-2.0
#include "tests/board/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace kerfbench::board {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint64_t kBegin = 5'000'000'000;
constexpr TickRate kRate{1, 16'000'000};
constexpr PinId kPul{0, 0};
constexpr PinId kDir{0, 1};
constexpr PinId kMark{3, 3};

/// A clock that advances only while the board sleeps (or puts out, if that takes time).
class ScriptedPorts : public BoardPorts {
 public:
  std::vector<std::pair<std::uint64_t, bool>> mark;  ///< Times at which the mark changes.
  std::vector<std::uint8_t> incoming, outgoing;
  std::vector<std::tuple<std::uint64_t, Signal, bool>> put_out;
  std::uint64_t put_takes_ns{};

  std::uint64_t now_ns() override { return now_; }
  void sleepUntil(std::uint64_t at_ns) override { now_ = std::max(now_, at_ns); }
  bool level(Signal /*sensor*/) override {
    bool now = false;
    for (const auto& [at, level] : mark) now = at <= now_ ? level : now;
    return now;
  }
  void put(Signal output, bool level) override {
    put_out.emplace_back(now_ - kBegin, output, level);
    now_ += put_takes_ns;
  }
  std::vector<std::uint8_t> receive() override { return std::exchange(incoming, {}); }
  void send(std::span<const std::uint8_t> bytes) override {
    outgoing.insert(outgoing.end(), bytes.begin(), bytes.end());
  }

 private:
  std::uint64_t now_{kBegin};
};

/// A scripted release, which answers what it receives.
class ScriptedRelease : public source::SignalSource {
 public:
  std::vector<PinEvent> events;
  std::vector<std::tuple<Tick, PinId, bool>> driven;
  Tick halts_at{~Tick{0}};

  [[nodiscard]] source::SourceInfo info() const override { return {kRate, 0, true, true, "script"}; }
  source::Stop advance(Tick until, source::Batch& batch) override {
    EXPECT_GT(until, watermark_);
    batch = {{}, std::exchange(heard_, {}), until, until};
    for (const PinEvent& event : events) {
      if (event.tick > watermark_ && event.tick <= until) batch.events.push_back(event);
    }
    watermark_ = until;
    return until >= halts_at ? source::Stop::kEnded : source::Stop::kReached;
  }
  void drive(PinId pin, bool level, Tick at) override {
    EXPECT_GT(at, watermark_);
    driven.emplace_back(at, pin, level);
  }
  void uartWrite(std::span<const std::uint8_t> bytes) override { heard_.assign(bytes.begin(), bytes.end()); }
  [[nodiscard]] std::string message() const override { return {}; }

 private:
  Tick watermark_{};
  std::vector<std::uint8_t> heard_;
};

class BoardTest : public testing::Test {
 protected:
  BoardTest() {
    pins.assign(Signal::kGalvoXPul, kPul);
    pins.assign(Signal::kGalvoXDir, kDir);
    pins.assign(Signal::kPrintMark, kMark);
  }
  BoardPace run() {
    Board board(release, pins, {Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kPrintMark}, ports, options);
    return board.run();
  }
  SignalMap pins;
  ScriptedPorts ports;
  ScriptedRelease release;
  BoardOptions options{.step_ns = 100'000, .delay_ns = 250'000, .run_ns = 2'000'000};
};

// One microsecond is 16 ticks.
TEST_F(BoardTest, EdgesKeepTheirDistancesAndComeLaterByTheDelay) {
  release.events = {{160, 0, 2, 2, 0}, {400, 0, 1, 3, 0}, {560, 0, 3, 0, 0}, {600, 2, 1, 1, 0}};
  const BoardPace pace = run();
  EXPECT_THAT(ports.put_out, ElementsAre(std::tuple(260'000, Signal::kGalvoXDir, true),
                                         std::tuple(275'000, Signal::kGalvoXPul, true),
                                         std::tuple(285'000, Signal::kGalvoXPul, false),
                                         std::tuple(285'000, Signal::kGalvoXDir, false)));
  EXPECT_EQ(pace.strokes, 4U);
  EXPECT_EQ(pace.worst_late_ns, 0U);
  EXPECT_EQ(pace.worst_step_ns, 100'000U);
  EXPECT_FALSE(pace.halted);
}

TEST_F(BoardTest, WhatIsLateIsMeasuredAndNothingIsLeftOut) {
  ports.put_takes_ns = 20'000;
  release.events = {{160, 0, 1, 1, 0}, {176, 0, 1, 0, 0}, {192, 0, 1, 1, 0}};
  const BoardPace pace = run();
  EXPECT_EQ(pace.strokes, 3U);
  EXPECT_EQ(pace.worst_late_ns, 38'000U);
}

TEST_F(BoardTest, AnInputReachesTheReleaseWhenItIsSeen) {
  ports.mark = {{kBegin + 430'000, true}, {kBegin + 900'001, false}};
  run();
  EXPECT_THAT(release.driven,
              ElementsAre(std::tuple(500 * 16, kMark, true), std::tuple(1000 * 16, kMark, false)));
}

TEST_F(BoardTest, TheUartGoesBothWays) {
  ports.incoming = {1, 2, 3};
  run();
  EXPECT_THAT(ports.outgoing, ElementsAre(1, 2, 3));
}

TEST_F(BoardTest, AReleaseThatHaltsEndsTheRun) {
  release.halts_at = 16'000;
  EXPECT_TRUE(run().halted);
  EXPECT_EQ(ports.now_ns(), kBegin + 1'000'000);
  EXPECT_THAT(ports.put_out, IsEmpty());
}

}  // namespace
}  // namespace kerfbench::board
