// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/print_mark_sensor.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {
namespace {

constexpr std::uint64_t kMarkSeed = 0x6d61726b73656e73ULL;

double nearestNeighbour_mm(const PrintLayout& print) {
  const double gap_mm =
      print.units > 1 ? print.pitch_mm - print.eye_mark_length_mm : print.eye_mark_length_mm;
  return std::max(0.0, std::min(gap_mm, print.eye_mark_length_mm));
}

}  // namespace

PrintMarkSensor::PrintMarkSensor(TickRate rate, const PrintMarkSensorDescription& sensor,
                                 const PrintLayout& print, double first_mark_mm, std::uint64_t seed)
    : rate_(rate),
      sensor_(sensor),
      print_(print),
      first_mark_mm_(first_mark_mm),
      max_jitter_mm_(0.4 * nearestNeighbour_mm(print)),
      random_(seed ^ kMarkSeed, 0) {
  // Marks that passed before the start were never seen.
  while (passed_ < 2LL * print_.units && edge_mm(passed_ + 1) < 0) passed_ += 2;
}

double PrintMarkSensor::edge_mm(long long edge) const {
  const long long unit = edge / 2;
  double place_mm = first_mark_mm_ + static_cast<double>(unit) * print_.pitch_mm +
                    (edge % 2 == 0 ? 0.0 : print_.eye_mark_length_mm);
  if (sensor_.jitter_mm > 0.0) {
    place_mm += std::clamp(sensor_.jitter_mm * random_.normal(static_cast<std::uint64_t>(edge)),
                           -max_jitter_mm_, max_jitter_mm_);
  }
  return place_mm;
}

void PrintMarkSensor::predict(const MotionForecast& sheet, Tick until, std::vector<SensorEdge>& edges) {
  const double end_mm = sheet.placeAfter_mm(rate_.seconds(until - sheet.now));
  const auto send = [&](long long edge, double place_mm, bool forward) {
    // Even edges are a mark's begin: the mark is under the sensor after passing forwards, and before it after
    // passing backwards.
    edges.push_back(
        {sheet.tickAt(place_mm, forward, rate_, until), Signal::kPrintMark, (edge % 2 == 0) == forward});
  };
  while (passed_ < 2LL * print_.units) {
    const double place_mm = edge_mm(passed_);
    if (end_mm < place_mm) break;
    send(passed_++, place_mm, true);
  }
  while (passed_ > 0) {
    const double place_mm = edge_mm(passed_ - 1) - sensor_.hysteresis_mm;
    if (end_mm >= place_mm) break;
    send(--passed_, place_mm, false);
  }
}

}  // namespace kerfbench::twin
