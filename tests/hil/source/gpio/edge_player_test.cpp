// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/edge_player.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>

#include "hil/source/gpio/lag_meter.h"
#include "tests/hil/source/gpio/scripted_kernel.h"

namespace kerfbench::source {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Driven = ScriptedKernel::Driven;

constexpr std::uint64_t kStart = ScriptedKernel::kStart_ns;

class EdgePlayerTest : public testing::Test {
 protected:
  const std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
  EdgePlayer player{kernel, OutputLines(kernel, "/dev/gpiochip0", {{0, "a"}, {1, "b"}}, {false, false})};
  std::vector<PlayedEdge> played;
};

TEST_F(EdgePlayerTest, NothingIsPutOutBeforeItsTime) {
  player.plan(0, true, kStart + 100);
  EXPECT_EQ(player.nextDue_ns(), kStart + 100);
  kernel->passTime(99);
  player.play(played);
  EXPECT_THAT(kernel->driven, IsEmpty());
  kernel->passTime(1);
  player.play(played);
  EXPECT_THAT(kernel->driven, ElementsAre(Driven{kStart + 100, 1, 1}));
  EXPECT_EQ(player.nextDue_ns(), EdgePlayer::kNever);
}

TEST_F(EdgePlayerTest, EdgesComeInOrderOfTimeAndThoseOfOneInstantTogether) {
  player.plan(1, true, kStart + 30);
  player.plan(0, true, kStart + 10);
  player.plan(0, false, kStart + 30);
  kernel->passTime(30);
  player.play(played);
  EXPECT_THAT(kernel->driven, ElementsAre(Driven{kStart + 30, 0b01, 0b01}, Driven{kStart + 30, 0b11, 0b10}));
}

// A quadrature pair that is put out late must not become one step of two counts.
TEST_F(EdgePlayerTest, WhatIsLateIsPutOutEdgeByEdgeAndItsLagIsWhenTheCallCameBack) {
  kernel->set_takes_ns = 5;
  player.plan(0, true, kStart + 10);
  player.plan(1, true, kStart + 20);
  player.plan(0, false, kStart + 30);
  kernel->passTime(100);
  player.play(played);
  ASSERT_EQ(kernel->driven.size(), 3U);
  LagMeter lag;
  for (const PlayedEdge& edge : played)
    lag.add(static_cast<std::int64_t>(edge.put_ns - edge.planned_ns), edge.put_ns);
  EXPECT_EQ(played[0].put_ns, kStart + 105);
  EXPECT_EQ(played[2].put_ns, kStart + 115);
  EXPECT_EQ(lag.edges(), 3U);
  EXPECT_EQ(lag.worst_ns(), 95);
  EXPECT_EQ(lag.worstAt_ns(), kStart + 105);
  EXPECT_NEAR(lag.rms_ns(), std::sqrt((95.0 * 95 + 90.0 * 90 + 85.0 * 85) / 3), 1e-9);
}

TEST_F(EdgePlayerTest, EdgesOfALineKeepTheirOrderWhateverTheirTimes) {
  player.plan(0, true, kStart + 50);
  player.plan(0, false, kStart + 20);
  kernel->passTime(100);
  player.play(played);
  EXPECT_THAT(kernel->driven, ElementsAre(Driven{kStart + 100, 1, 1}, Driven{kStart + 100, 1, 0}));
  // The lag counts from the wish.
  EXPECT_EQ(played[1].planned_ns, kStart + 20);
  EXPECT_GT(played[1].put_ns, played[0].put_ns);
}

TEST_F(EdgePlayerTest, AnEdgeThatTheKernelRefusesIsNotTakenForPutOut) {
  player.plan(0, true, kStart);
  kernel->set_error = ENODEV;
  EXPECT_THROW(player.play(played), GpioError);
  EXPECT_THAT(played, IsEmpty());
}

TEST(LagMeterTest, WithoutEdgesThereIsNoLag) {
  const LagMeter lag;
  EXPECT_EQ(lag.worst_ns(), 0);
  EXPECT_EQ(lag.rms_ns(), 0.0);
}

}  // namespace
}  // namespace kerfbench::source
