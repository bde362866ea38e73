// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/power_monitor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kStepS = 10e-6;

// Edges for a laser whose power wanders; the monitor is queried every `quantum` ticks.
std::vector<SensorEdge> edgesOf(const PowerMonitorDescription& description, Tick quantum, double end_s,
                                double power_w = 0.0) {
  const CounterRandom random(2, 3);
  PowerMonitor monitor(kRate, description);
  monitor.connect();
  std::vector<SensorEdge> edges;
  std::uint64_t step = 0;
  for (Tick now = 0; kRate.seconds(now) < end_s; now += quantum) {
    monitor.predict(now, now + quantum, edges);
    while (static_cast<double>(step + 1) * kStepS <= kRate.seconds(now + quantum) + 1e-12) {
      const double w = power_w > 0.0 ? power_w : 100.0 * random.uniform(step);
      monitor.emitted(w * kStepS, static_cast<double>(step) * kStepS, kStepS);
      ++step;
    }
  }
  return edges;
}

TEST(PowerMonitor, TogglesForEachQuantumOfEnergyAfterItsDelay) {
  const auto edges = edgesOf({.quantum_j = 5e-3, .delay_s = 1e-3}, 8000, 0.1, 80.0);
  ASSERT_GT(edges.size(), 1500U);  // The power is 80 W: one edge each 62.5 us.
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(edges[i].signal, Signal::kPowerMonitor);
    EXPECT_EQ(edges[i].level, i % 2 == 0);
    const double at_s = 1e-3 + 62.5e-6 * static_cast<double>(i + 1);
    ASSERT_NEAR(static_cast<double>(edges[i].tick), at_s * 16e6, 1.01) << i;
  }
}

TEST(PowerMonitor, AMeterThatReadsHighSendsMoreEdges) {
  const auto count = [](double scale) {
    return static_cast<double>(
        edgesOf({.quantum_j = 1e-3, .delay_s = 1e-3, .scale = scale}, 8000, 1.0, 50.0).size());
  };
  EXPECT_NEAR(count(1.1) / count(1.0), 1.1, 1e-4);
}

TEST(PowerMonitor, SendsTheSameEdgesForAnyQuantaThatAreShorterThanTheDelay) {
  const PowerMonitorDescription description{.quantum_j = 0.3e-3, .delay_s = 0.6e-3};
  const auto reference = edgesOf(description, 8000, 0.2);
  ASSERT_GT(reference.size(), 30000U);  // Some steps contain several edges.
  for (const Tick quantum : {Tick{1600}, Tick{1237}, Tick{9440}}) {
    const auto edges = edgesOf(description, quantum, 0.2);
    ASSERT_GE(edges.size() + 30, reference.size());
    for (std::size_t i = 0; i < std::min(edges.size(), reference.size()); ++i) {
      ASSERT_EQ(edges[i].tick, reference[i].tick) << i;
      ASSERT_EQ(edges[i].level, reference[i].level) << i;
    }
  }
}

TEST(PowerMonitor, NoEdgeIsLostWhereAQuantumIsLongerThanTheDelay) {
  const PowerMonitorDescription description{.quantum_j = 1e-3, .delay_s = 0.5e-3};
  const auto edges = edgesOf(description, 16000 * 5, 0.1, 100.0);
  EXPECT_NEAR(static_cast<double>(edges.size()), 95e-3 * 100.0 / 1e-3, 2.0);
  for (std::size_t i = 0; i < edges.size(); ++i) ASSERT_EQ(edges[i].level, i % 2 == 0);
}

TEST(PowerMonitor, ADarkLaserSendsNothing) {
  PowerMonitor monitor(kRate, {});
  monitor.connect();
  std::vector<SensorEdge> edges;
  for (int i = 0; i < 1000; ++i) monitor.emitted(0.0, i * kStepS, kStepS);
  monitor.predict(0, 16'000'000, edges);
  EXPECT_TRUE(edges.empty());
}

}  // namespace
}  // namespace kerfbench::twin
