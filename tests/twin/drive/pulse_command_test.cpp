// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/pulse_command.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kStep = 12.5e-6;
constexpr double kTickS = 1.0 / 16e6;

std::vector<StepEdge> randomEdges(int count, double mean_gap_s) {
  const CounterRandom random(7, 1);
  std::vector<StepEdge> edges;
  double at_s = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    at_s += std::max(1.0, std::round(2.0 * mean_gap_s * random.uniform(2 * index) / kTickS)) * kTickS;
    edges.push_back({at_s, random.uniform(2 * index + 1) < 0.6 ? 1 : -1});
  }
  return edges;
}

// Area under the staircase, edge by edge.
double bruteMean(const std::vector<StepEdge>& edges, double begin_s, double end_s) {
  double area = 0.0;
  for (const StepEdge& edge : edges) {
    area += edge.direction * std::max(0.0, end_s - std::max(edge.time_s, begin_s));
  }
  return area / (end_s - begin_s) * kStep;
}

TEST(PulseCommand, ItsMeanIsTheAreaUnderTheStaircaseForAnyEdges) {
  for (const double gap_s : {1e-6, 7e-6, 200e-6}) {
    const auto edges = randomEdges(3000, gap_s);
    PulseCommand command(kStep);
    command.incoming() = edges;
    const double end_s = edges.back().time_s + 50e-6;
    for (int i = 0; (i + 1) * 10e-6 < end_s && i < 1500; ++i) {
      const double expected = bruteMean(edges, i * 10e-6, (i + 1) * 10e-6);
      ASSERT_NEAR(command.meanOver(i * 10e-6, (i + 1) * 10e-6), expected, 1e-9 * kStep) << i;
    }
  }
}

TEST(PulseCommand, DoesNotDependOnHowEdgesArriveInGroups) {
  const auto edges = randomEdges(20000, 3e-6);
  const int intervals = static_cast<int>(edges.back().time_s / 10e-6);
  PulseCommand at_once(kStep);
  at_once.incoming() = edges;
  PulseCommand bit_by_bit(kStep);
  std::size_t next = 0;
  for (int i = 0; i < intervals; ++i) {
    while (next < edges.size() && edges[next].time_s < (i + 1) * 10e-6) {
      bit_by_bit.incoming().push_back(edges[next++]);
    }
    ASSERT_EQ(at_once.meanOver(i * 10e-6, (i + 1) * 10e-6), bit_by_bit.meanOver(i * 10e-6, (i + 1) * 10e-6));
    ASSERT_EQ(at_once.position(), bit_by_bit.position());
  }
}

TEST(PulseCommand, TheMeanOfALongIntervalIsTheMeanOfItsParts) {
  const auto edges = randomEdges(400, 5e-6);
  PulseCommand whole(kStep);
  PulseCommand parts(kStep);
  whole.incoming() = edges;
  parts.incoming() = edges;
  for (int i = 0; i < 15; ++i) {
    double sum = 0.0;
    for (int k = 0; k < 10; ++k) sum += parts.meanOver((10 * i + k) * 10e-6, (10 * i + k + 1) * 10e-6);
    EXPECT_NEAR(whole.meanOver(i * 100e-6, (i + 1) * 100e-6), 0.1 * sum, 1e-10 * kStep);
    EXPECT_EQ(whole.position(), parts.position());
  }
}

TEST(PulseCommand, EndsWhereItsStepsLeadAndStaysThere) {
  PulseCommand command(kStep);
  for (int i = 0; i < 9000; ++i) command.incoming().push_back({1e-6 * (i + 1), i % 3 == 0 ? -1 : 1});
  EXPECT_NE(command.meanOver(0.0, 10e-3), 3000 * kStep);
  EXPECT_EQ(command.position(), 3000 * kStep);
  EXPECT_EQ(command.meanOver(10e-3, 10.01e-3), 3000 * kStep);
  command.incoming().push_back({10.015e-3, 1});
  EXPECT_NEAR(command.meanOver(10.01e-3, 10.02e-3), 3000.5 * kStep, 1e-9 * kStep);
}

}  // namespace
}  // namespace kerfbench::twin
