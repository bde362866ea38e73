// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/status_report.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "hil/base/number_from.h"
#include "hil/base/text.h"

namespace kerfbench::controller {
namespace {

constexpr double kInch_mm = 25.4;
constexpr double kInchResolution = 1.5e-4;  // Grbl prints mm with three digits and inches with four.
constexpr std::size_t kLongestLine = 512;

double resolutionOf(std::string_view number) {
  const auto point = number.find('.');
  return point == std::string_view::npos ? 1.0
                                         : std::pow(10.0, -static_cast<double>(number.size() - point - 1));
}

/// Steps that a place in mm says; those that were seen, if they are it.
long long stepsOf(double place_mm, double resolution_mm, double step_mm, long long seen) {
  const double off_mm = std::abs(place_mm - static_cast<double>(seen) * step_mm);
  // A digit's half, and as much again for firmware that cuts digits off.
  if (off_mm <= resolution_mm) return seen;
  return std::llround(place_mm / step_mm);
}

/// A line "<Idle|MPos:1.000,2.000,0.000|…>", or with commas, as Grbl had it before 1.1.
std::optional<StatusReport> reportIn(std::string_view line) {
  constexpr std::string_view kPlace = "MPos:";
  if (line.size() < 2 || line.front() != '<' || line.back() != '>') return std::nullopt;
  line = line.substr(1, line.size() - 2);
  StatusReport report;
  report.state = line.substr(0, line.find_first_of("|,:"));
  const auto at = line.find(kPlace);
  if (at == std::string_view::npos || at == 0 || (line[at - 1] != '|' && line[at - 1] != ','))
    return std::nullopt;
  line.remove_prefix(at + kPlace.size());
  for (double& place : report.machine_place) {
    const std::string_view number = line.substr(0, line.find_first_of(",|"));
    const auto value = base::numberFrom<double>(std::string(number));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    place = *value;
    report.resolution = resolutionOf(number);
    line.remove_prefix(std::min(line.size(), number.size() + 1));
  }
  return report;
}

/// Calls `take` with each line and the time of its end.
template <class Take>
void forEachLine(const source::PinRecording& recording, Take take) {
  std::string line;
  for (const source::ReceivedBytes& received : recording.uart) {
    for (const std::uint8_t byte : received.bytes) {
      if (byte != '\n') {
        if (line.size() <= kLongestLine) line += static_cast<char>(byte);
        continue;
      }
      if (line.size() <= kLongestLine) take(base::trimmed(line), received.tick);
      line.clear();
    }
  }
}

}  // namespace

StatusWords statusWords(const source::PinRecording& recording) {
  StatusWords words;
  forEachLine(recording, [&](std::string_view line, Tick tick) {
    if (line == "ok" && !words.first_ok) words.first_ok = tick;
    std::optional<StatusReport> report = reportIn(line);
    if (!report) return;
    report->heard = tick;
    words.last = std::move(report);
  });
  return words;
}

inspect::ControllerAccount compareWithStatus(const StatusReport& report, const PulseCounter& pins,
                                             const std::array<ReportedAxis, 2>& axes) {
  const double unit_mm = report.resolution < kInchResolution ? kInch_mm : 1.0;
  inspect::ControllerAccount account;
  account.told = true;
  for (const std::size_t i : {0U, 1U}) {
    const std::optional<long long> seen = pins.net(axes.at(i).pul);
    if (!seen) continue;
    account.axes.push_back({axisNameOf(axes.at(i).pul),
                            stepsOf(report.machine_place.at(i) * unit_mm, report.resolution * unit_mm,
                                    axes.at(i).step_mm, *seen),
                            *seen});
  }
  return account;
}

}  // namespace kerfbench::controller
