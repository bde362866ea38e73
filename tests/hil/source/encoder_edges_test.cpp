// SPDX-License-Identifier: Apache-2.0
#include "hil/source/encoder_edges.h"

#include <gtest/gtest.h>

namespace kerfbench::source {
namespace {

constexpr TickRate kRate{1, 1000};

std::vector<long long> countsOf(const std::vector<SensorEdge>& sensors) {
  std::vector<long long> counts;
  for (const EncoderEdge& edge : encoderEdges(base::SpilledVector<SensorEdge>(sensors), kRate))
    counts.push_back(edge.counts);
  return counts;
}

constexpr Signal kA = Signal::kEncoderA;
constexpr Signal kB = Signal::kEncoderB;

TEST(EncoderEdges, ALeadsForwards) {
  EXPECT_EQ(countsOf({{1, kA, true}, {2, kB, true}, {3, kA, false}, {4, kB, false}, {5, kA, true}}),
            (std::vector<long long>{1, 2, 3, 4, 5}));
}

TEST(EncoderEdges, BLeadsBackwards) {
  EXPECT_EQ(countsOf({{1, kB, true}, {2, kA, true}, {3, kB, false}, {4, kA, false}}),
            (std::vector<long long>{-1, -2, -3, -4}));
}

TEST(EncoderEdges, ABeltThatTurnsComesBackToWhereItWas) {
  EXPECT_EQ(countsOf({{1, kA, true}, {2, kB, true}, {3, kB, false}, {4, kA, false}}),
            (std::vector<long long>{1, 2, 1, 0}));
}

TEST(EncoderEdges, OtherSignalsAndLevelsThatDoNotChangeArePassedOver) {
  const auto edges = encoderEdges(
      base::SpilledVector<SensorEdge>{
          {1, kA, false}, {2, Signal::kPrintMark, true}, {3, kA, true}, {4, kA, true}, {5, kB, true}},
      kRate);
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_DOUBLE_EQ(edges[0].time_s, 3e-3);
  EXPECT_DOUBLE_EQ(edges[1].time_s, 5e-3);
  EXPECT_EQ(edges[1].counts, 2);
}

}  // namespace
}  // namespace kerfbench::source
