// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/status_report.h"

#include <cmath>
#include <regex>
#include <string_view>

#include "hil/base/number_from.h"

namespace kerfbench::controller {
namespace {

constexpr double kInch_mm = 25.4;

double resolutionOf(const std::string& number) {
  const auto point = number.find('.');
  return point == std::string::npos ? 1.0 : std::pow(10.0, -static_cast<double>(number.size() - point - 1));
}

/// Steps that a place in a unit of so many mm says; those that were seen, if they round to it.
long long stepsOf(double place, double resolution, double unit_mm, double step_mm, long long seen) {
  const double off_mm = std::abs(place * unit_mm - static_cast<double>(seen) * step_mm);
  // A digit's half, and as much again for firmware that cuts digits off.
  if (off_mm <= resolution * unit_mm) return seen;
  return std::llround(place * unit_mm / step_mm);
}

}  // namespace

std::optional<StatusReport> lastStatus(const source::PinRecording& recording) {
  static const std::regex kReport(
      R"(<([A-Z][a-z]+)[^<>]*[|,]MPos:(-?[0-9]+\.?[0-9]*),(-?[0-9]+\.?[0-9]*)[^<>]*>)");
  std::string words;
  for (const auto& received : recording.uart) words.append(received.bytes.begin(), received.bytes.end());
  std::optional<StatusReport> last;
  for (std::sregex_iterator it(words.begin(), words.end(), kReport), end; it != end; ++it) {
    StatusReport report;
    report.state = (*it)[1];
    for (const std::size_t axis : {0U, 1U})
      report.machine_place.at(axis) = base::numberFrom<double>((*it)[2 + axis].str()).value_or(std::nan(""));
    report.resolution = resolutionOf((*it)[2]);
    last = std::move(report);
  }
  return last;
}

inspect::ControllerAccount compareWithStatus(const StatusReport& report, const PulseCounter& pins,
                                             const std::array<ReportedAxis, 2>& axes) {
  inspect::ControllerAccount account;
  account.told = true;
  for (const std::size_t i : {0U, 1U}) {
    const std::optional<long long> seen = pins.net(axes.at(i).pul);
    if (!seen) continue;
    const auto told = [&](double unit_mm) {
      return stepsOf(report.machine_place.at(i), report.resolution, unit_mm, axes.at(i).step_mm, *seen);
    };
    const long long in_inches = told(kInch_mm);
    account.axes.push_back({axisNameOf(axes.at(i).pul), in_inches == *seen ? in_inches : told(1.0), *seen});
  }
  return account;
}

}  // namespace kerfbench::controller
