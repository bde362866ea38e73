// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/sensors.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {
namespace {

double travelAfter(const BeltForecast& f, double dt_s) {
  return f.travel_mm + f.speed_mm_s * dt_s + 0.5 * f.acceleration_mm_s2 * dt_s * dt_s;
}

// When the forecast has passed `travel_mm` in this direction: s from now, in [0, limit_s]; 0 if it has
// already.
double timeOf(const BeltForecast& f, double travel_mm, bool forward, double limit_s) {
  double low_s = 0.0;
  double high_s = limit_s;
  // Within a quantum the belt does not turn back and forth, so bisection is safe; 50 halvings reach a
  // femtosecond.
  for (int i = 0; i < 50; ++i) {
    const double mid_s = 0.5 * (low_s + high_s);
    const bool passed = forward ? travelAfter(f, mid_s) >= travel_mm : travelAfter(f, mid_s) <= travel_mm;
    (passed ? high_s : low_s) = mid_s;
  }
  return high_s;
}

Tick tickOf(const BeltForecast& f, TickRate rate, double travel_mm, bool forward, Tick until) {
  const double dt_s = timeOf(f, travel_mm, forward, rate.seconds(until - f.now));
  return std::clamp<Tick>(f.now + rate.ticksAt(dt_s) + 1, f.now + 1, until);
}

}  // namespace

BeltSensors::BeltSensors(TickRate rate, double encoder_count_mm, const PrintLayout& print,
                         double first_mark_mm)
    : rate_(rate), encoder_count_mm_(encoder_count_mm), print_(print), first_mark_mm_(first_mark_mm) {
  // Marks that have passed before the start were never seen.
  while (mark_edges_ < 2LL * print_.units && markEdgeTravel_mm(mark_edges_ + 1) < 0) mark_edges_ += 2;
}

double BeltSensors::markEdgeTravel_mm(long long edge) const {
  const long long mark = edge / 2;
  return first_mark_mm_ + static_cast<double>(mark) * print_.pitch_mm +
         (edge % 2 == 0 ? 0.0 : print_.eye_mark_length_mm);
}

std::vector<SensorEdge> BeltSensors::edges(const BeltForecast& forecast, Tick until) {
  std::vector<SensorEdge> edges;
  encoderEdges(forecast, until, edges);
  markEdges(forecast, until, edges);
  std::ranges::stable_sort(edges, {}, &SensorEdge::tick);
  return edges;
}

void BeltSensors::encoderEdges(const BeltForecast& forecast, Tick until, std::vector<SensorEdge>& edges) {
  const double end_mm = travelAfter(forecast, rate_.seconds(until - forecast.now));
  const auto target = static_cast<long long>(std::floor(end_mm / encoder_count_mm_));
  while (count_ != target) {
    const bool forward = target > count_;
    // The boundary between the present count and the next one.
    const double boundary_mm = static_cast<double>(forward ? count_ + 1 : count_) * encoder_count_mm_;
    count_ += forward ? 1 : -1;
    const Tick tick = tickOf(forecast, rate_, boundary_mm, forward, until);
    // Counts 0 1 2 3 are A B = 00 10 11 01: exactly one line changes at each boundary.
    const auto phase = static_cast<unsigned>(((count_ % 4) + 4) % 4);
    const bool a = phase == 1 || phase == 2;
    const bool b = phase >= 2;
    const bool a_changed = forward ? phase == 1 || phase == 3 : phase == 0 || phase == 2;
    edges.push_back(a_changed ? SensorEdge{tick, Signal::kEncoderA, a}
                              : SensorEdge{tick, Signal::kEncoderB, b});
  }
}

void BeltSensors::markEdges(const BeltForecast& forecast, Tick until, std::vector<SensorEdge>& edges) {
  const double end_mm = travelAfter(forecast, rate_.seconds(until - forecast.now));
  const auto send = [&](long long edge, bool forward) {
    // Even edges are a mark's begin: under it after passing forward, before it after passing back.
    edges.push_back({tickOf(forecast, rate_, markEdgeTravel_mm(edge), forward, until), Signal::kPrintMark,
                     (edge % 2 == 0) == forward});
  };
  while (mark_edges_ < 2LL * print_.units && end_mm >= markEdgeTravel_mm(mark_edges_)) {
    send(mark_edges_++, true);
  }
  while (mark_edges_ > 0 && end_mm < markEdgeTravel_mm(mark_edges_ - 1)) send(--mark_edges_, false);
}

}  // namespace kerfbench::twin
