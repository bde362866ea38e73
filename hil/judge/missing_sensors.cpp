// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/missing_sensors.h"

#include <algorithm>

#include <fmt/format.h>

namespace kerfbench::judge {
namespace {

/// Distance by which the web may lag behind its encoder.
constexpr double kSlip_mm = 1.0;

/// Travel of the web by its encoder up to a time, mm.
double travelAt(const std::vector<inspect::BeltEdge>& belt, double time_s) {
  const auto after = std::ranges::upper_bound(belt, time_s, {}, &inspect::BeltEdge::time_s);
  return after == belt.begin() ? 0.0 : (after - 1)->x_mm;
}

/// Eye marks that travel past their sensor, by where the web lies at t = 0.
int marksThatPass(const scenario::Case& test_case, double travel_mm) {
  const twin::WebDescription web = scenario::webOf(test_case);
  const double sensor_x_mm = test_case.machine.controller.print_mark_sensor_x_mm;
  int count = 0;
  for (int unit = 0; unit < web.print.units; ++unit) {
    const double x_mm = web.start_x_mm - unit * web.print.pitch_mm + web.print.eye_mark_x_mm;
    if (x_mm < sensor_x_mm && x_mm + travel_mm > sensor_x_mm + kSlip_mm) ++count;
  }
  return count;
}

}  // namespace

std::vector<std::string> missingSensors(const scenario::Case& test_case,
                                        const source::PinRecording& recording,
                                        const inspect::Evidence& pins) {
  const SignalMap& wired = test_case.machine.signals;
  std::vector<std::string> problems;
  // What the controller feeds moves between the cuts, if at all.
  if (!test_case.scenario.sheetMoves() || test_case.scenario.belt_by_controller || pins.gates.empty())
    return problems;
  if (wired.pin(Signal::kEncoderA) && wired.pin(Signal::kEncoderB) && pins.belt.empty()) {
    problems.push_back(
        fmt::format("The web moves at {:g} mm/s, and the recording holds no edge of its encoder.",
                    test_case.scenario.belt_speed_mm_s));
  }
  if (!wired.pin(Signal::kPrintMark)) return problems;
  const auto seen = std::ranges::count_if(recording.sensors.streamed(), [](const SensorEdge& edge) {
    return edge.signal == Signal::kPrintMark && edge.level;
  });
  const int due = marksThatPass(test_case, travelAt(pins.belt, pins.gates.back().off_s));
  if (seen < due) {
    problems.push_back(fmt::format(
        "{} printed eye marks passed their sensor, and the recording holds the edges of {}.", due, seen));
  }
  return problems;
}

}  // namespace kerfbench::judge
