// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/edge_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace kerfbench::source {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kBegin = 1'000'000'000;
constexpr std::uint64_t kLater = kBegin + 1'000'000'000;

/// Edges of two lines that toggle as a good kernel reports them.
std::vector<KernelEdge> wire(std::size_t count, std::uint64_t period_ns = 10'000) {
  std::vector<KernelEdge> edges;
  std::uint32_t line_seqno[2] = {};
  bool level[2] = {};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t line = i % 3 == 2 ? 1 : 0;
    level[line] = !level[line];
    edges.push_back({kBegin + (i + 1) * period_ns, line, level[line], static_cast<std::uint32_t>(i + 1),
                     ++line_seqno[line]});
  }
  return edges;
}

struct Outcome {
  std::vector<LineEdge> edges;
  EdgeFaults faults;
  std::vector<std::string> problems;
  [[nodiscard]] bool anyGap() const { return std::ranges::any_of(edges, &LineEdge::gap); }
};

Outcome outcomeOf(const std::vector<KernelEdge>& edges) {
  EdgeOrder order({false, false}, kBegin);
  order.add(edges, kLater);
  Outcome outcome;
  order.takeAll(outcome.edges);
  outcome.faults = order.faults();
  outcome.problems = order.problems();
  return outcome;
}

TEST(EdgeOrder, GoodEdgesPassUnchangedAndAtOnce) {
  EdgeOrder order({false, false}, kBegin);
  const auto edges = wire(30);
  order.add(edges, kLater);
  std::vector<LineEdge> taken;
  order.take(kLater, kLater, taken);
  ASSERT_EQ(taken.size(), edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(taken[i].stamp_ns, edges[i].stamp_ns);
    EXPECT_EQ(taken[i].line, edges[i].line);
    EXPECT_EQ(taken[i].level, edges[i].level);
    EXPECT_TRUE(taken[i].changed);
    EXPECT_FALSE(taken[i].gap);
  }
  EXPECT_THAT(order.problems(), IsEmpty());
  EXPECT_EQ(order.edges(), edges.size());
}

TEST(EdgeOrder, EdgesAreHandedOnUpToATimeAndNoFurther) {
  EdgeOrder order({false, false}, kBegin);
  order.add(wire(10), kLater);
  std::vector<LineEdge> taken;
  order.take(kLater, kBegin + 50'000, taken);
  EXPECT_EQ(taken.size(), 5U);
  order.take(kLater, kBegin + 59'999, taken);
  EXPECT_EQ(taken.size(), 5U);
  order.take(kLater, kBegin + 60'000, taken);
  EXPECT_EQ(taken.size(), 6U);
}

// The two lines have two interrupt threads.
TEST(EdgeOrder, EdgesInTheWrongOrderAreBroughtIntoTheirs) {
  const auto edges = wire(200);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto shuffled = edges;
    std::mt19937 random(seed);
    for (std::size_t from = 0; from + 10 <= shuffled.size(); from += 10)
      std::ranges::shuffle(shuffled.begin() + static_cast<std::ptrdiff_t>(from),
                           shuffled.begin() + static_cast<std::ptrdiff_t>(from + 10), random);
    EdgeOrder order({false, false}, kBegin);
    std::vector<LineEdge> taken;
    for (const KernelEdge& edge : shuffled) {
      order.add({edge}, kLater);
      order.take(kLater, kBegin, taken);
    }
    order.takeAll(taken);
    ASSERT_EQ(taken.size(), edges.size());
    for (std::size_t i = 0; i < edges.size(); ++i) ASSERT_EQ(taken[i].stamp_ns, edges[i].stamp_ns);
    EXPECT_THAT(order.problems(), IsEmpty()) << seed;
  }
}

TEST(EdgeOrder, AMissingNumberIsWaitedForAndThenGivenUp) {
  const auto edges = wire(3);
  EdgeOrder order({false, false}, kBegin);
  order.add({edges[0], edges[2]}, kLater);
  std::vector<LineEdge> taken;
  order.take(kLater + EdgeOrder::kHold_ns - 1, kBegin + 1'000, taken);
  EXPECT_EQ(order.edges(), 1U);
  EXPECT_THAT(order.problems(), IsEmpty());
  order.take(kLater + EdgeOrder::kHold_ns, kBegin + 1'000, taken);
  EXPECT_EQ(order.edges(), 2U);
  EXPECT_EQ(order.faults().missing, 1U);
  // A late edge has lost its place.
  order.add({edges[1]}, kLater + EdgeOrder::kHold_ns);
  EXPECT_EQ(order.faults().twice, 1U);
}

// An edge of a run that is lost in the kernel shows in the numbers of the request, not in those of the line.
TEST(EdgeOrder, AnEdgeThatIsMergedAnywhereButAtTheEndIsNoticed) {
  const auto edges = wire(31);
  for (std::size_t lost = 0; lost + 1 < edges.size(); ++lost) {
    auto merged = edges;
    for (std::size_t i = lost + 1; i < merged.size(); ++i) {
      if (merged[i].line == merged[lost].line) --merged[i].line_seqno;
    }
    merged.erase(merged.begin() + static_cast<std::ptrdiff_t>(lost));
    const Outcome outcome = outcomeOf(merged);
    EXPECT_EQ(outcome.faults.missing, 1U) << lost;
    EXPECT_EQ(outcome.faults.dropped, 0U) << lost;
    EXPECT_TRUE(outcome.anyGap()) << lost;
    EXPECT_THAT(outcome.problems.at(0), HasSubstr("faster than its interrupt thread"));
  }
}

// The oldest edges are dropped: only the first number, which is not 1, shows it.
TEST(EdgeOrder, ABufferThatWasFullBeforeTheFirstReadIsNoticed) {
  auto edges = wire(40);
  edges.erase(edges.begin(), edges.begin() + 12);
  const Outcome outcome = outcomeOf(edges);
  EXPECT_EQ(outcome.faults.missing, 12U);
  EXPECT_EQ(outcome.faults.dropped, 12U);
  EXPECT_THAT(outcome.problems, ElementsAre(HasSubstr("12 edges lost because the kernel's buffer was full")));
  EXPECT_TRUE(outcome.edges.front().gap);
}

TEST(EdgeOrder, ABufferThatWasFullLaterIsNoticed) {
  auto edges = wire(40);
  edges.erase(edges.begin() + 20, edges.begin() + 26);
  const Outcome outcome = outcomeOf(edges);
  EXPECT_EQ(outcome.faults.missing, 6U);
  EXPECT_EQ(outcome.faults.dropped, 6U);
}

// The level on a late thread is that of a later edge.
TEST(EdgeOrder, TwoEdgesOfOneSortAreMergedOnes) {
  auto edges = wire(10);
  edges[1].level = !edges[1].level;
  const Outcome outcome = outcomeOf(edges);
  EXPECT_GE(outcome.faults.repeated, 1U);
  EXPECT_TRUE(outcome.edges[1].gap);
  EXPECT_FALSE(outcome.edges[1].changed);
  EXPECT_THAT(outcome.problems, ElementsAre(HasSubstr("merged into one")));
}

TEST(EdgeOrder, TheFirstEdgeIsHeldAgainstTheLevelAtTheStart) {
  EdgeOrder order({true, false}, kBegin);
  order.add(wire(1), kLater);
  EXPECT_EQ(order.faults().repeated, 0U);
  std::vector<LineEdge> taken;
  order.takeAll(taken);
  EXPECT_EQ(order.faults().repeated, 1U);
}

TEST(EdgeOrder, StampsOfTwoLinesMayCrossByTheRaceOfTwoProcessors) {
  auto edges = wire(6);
  edges[2].stamp_ns = edges[1].stamp_ns - EdgeOrder::kRace_ns;  // Stamp of the other line.
  const Outcome outcome = outcomeOf(edges);
  EXPECT_THAT(outcome.problems, IsEmpty());
  EXPECT_EQ(outcome.edges[2].stamp_ns, edges[1].stamp_ns);
  --edges[2].stamp_ns;
  EXPECT_EQ(outcomeOf(edges).faults.backwards, 1U);
  EXPECT_EQ(outcomeOf(edges).faults.worst_backwards_ns, EdgeOrder::kRace_ns + 1);
}

TEST(EdgeOrder, StampsOfOneLineMayNotGoBackAtAll) {
  auto edges = wire(6);
  for (const std::uint64_t back : {0U, 1U, 500'000'000U}) {
    edges[1].stamp_ns = edges[0].stamp_ns - back;
    const Outcome outcome = outcomeOf(edges);
    EXPECT_GE(outcome.faults.backwards, 1U) << back;
    EXPECT_THAT(outcome.problems.at(0), HasSubstr("went back"));
    EXPECT_GT(outcome.edges[1].stamp_ns, outcome.edges[0].stamp_ns);
  }
}

TEST(EdgeOrder, WhateverComesStampsAscendAndNoWireChangesTwiceAtOne) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    auto edges = wire(60);
    for (KernelEdge& edge : edges) {
      if (random() % 4 == 0) edge.stamp_ns += random() % 40'000 - 20'000;
      if (random() % 8 == 0) edge.seqno += static_cast<std::uint32_t>(random() % 5);
      if (random() % 8 == 0) edge.level = !edge.level;
    }
    std::ranges::shuffle(edges, random);
    EdgeOrder order({false, false}, kBegin);
    std::vector<LineEdge> taken;
    for (const KernelEdge& edge : edges) {
      order.add({edge}, kBegin + 700'000);
      order.take(kBegin + 700'000, kBegin + random() % 300'000, taken);
    }
    order.takeAll(taken);
    std::uint64_t last_ns = kBegin;
    std::uint64_t of_line_ns[2] = {kBegin, kBegin};
    for (const LineEdge& edge : taken) {
      ASSERT_GE(edge.stamp_ns, last_ns);
      ASSERT_GT(edge.stamp_ns, of_line_ns[edge.line]);
      last_ns = of_line_ns[edge.line] = edge.stamp_ns;
    }
  }
}

TEST(EdgeOrder, AnEdgeBeforeTheStartOrAfterItsTimeOrFromTheFutureIsAFault) {
  auto edges = wire(3);
  edges[0].stamp_ns = kBegin;
  EXPECT_EQ(outcomeOf(edges).faults.early, 1U);
  EXPECT_THAT(outcomeOf(edges).problems, ElementsAre(HasSubstr("start the bench before the controller")));

  edges = wire(3);
  edges[2].stamp_ns = kLater + 1;
  EXPECT_EQ(outcomeOf(edges).faults.future, 1U);
  EXPECT_TRUE(outcomeOf(edges).anyGap());

  EdgeOrder order({false, false}, kBegin);
  std::vector<LineEdge> taken;
  order.take(kLater, kBegin + 20'000, taken);
  order.add(wire(3), kLater);
  order.takeAll(taken);
  EXPECT_EQ(order.faults().late, 2U);
  EXPECT_GT(taken.front().stamp_ns, kBegin + 20'000);
}

TEST(EdgeOrder, ANumberThatComesTwiceIsAFault) {
  auto edges = wire(4);
  edges.insert(edges.begin() + 2, edges[1]);
  const Outcome outcome = outcomeOf(edges);
  EXPECT_EQ(outcome.faults.twice, 1U);
  EXPECT_EQ(outcome.edges.size(), 4U);
  EXPECT_TRUE(outcome.anyGap());
}

TEST(EdgeOrder, TheFirstTroubleIsTold) {
  auto edges = wire(10);
  edges.erase(edges.begin() + 4);
  EXPECT_EQ(outcomeOf(edges).faults.first_ns, edges[4].stamp_ns);
}

}  // namespace
}  // namespace kerfbench::source
