// SPDX-License-Identifier: Apache-2.0
#include "hil/run/sensor_lag.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "hil/source/encoder_edges.h"
#include "hil/source/gpio/live_source.h"

namespace kerfbench::run {
namespace {

constexpr double kOnSheet_mm = 0.01;
// Step of the model of the gantry, behind the hold-back.
constexpr double kLimitSwitch_s = 0.005;

/// Signal, direction or level, count of the encoder.
using Kind = std::tuple<Signal, bool, long long>;

struct TimedEdge {
  double time_s{};
  Kind kind;
};

bool isEncoder(Signal signal) { return signal == Signal::kEncoderA || signal == Signal::kEncoderB; }

std::vector<TimedEdge> timedEdges(std::span<const SensorEdge> edges, TickRate rate,
                                  const std::vector<Signal>& signals) {
  std::vector<SensorEdge> wanted(edges.begin(), edges.end());
  std::erase_if(wanted, [&](const SensorEdge& edge) {
    return std::ranges::find(signals, edge.signal) == signals.end();
  });
  std::ranges::stable_sort(wanted, {}, &SensorEdge::tick);
  std::vector<TimedEdge> timed;
  long long before = 0;
  for (const source::EncoderEdge& edge : source::encoderEdges(wanted, rate)) {
    timed.push_back({edge.time_s, {Signal::kEncoderA, edge.counts > before, edge.counts}});
    before = edge.counts;
  }
  for (const SensorEdge& edge : wanted) {
    if (!isEncoder(edge.signal)) timed.push_back({rate.seconds(edge.tick), {edge.signal, edge.level, 0}});
  }
  std::ranges::stable_sort(timed, {}, &TimedEdge::time_s);
  return timed;
}

/// Times of edges, by kind.
class EdgeIndex {
 public:
  explicit EdgeIndex(const std::vector<TimedEdge>& edges) {
    for (const TimedEdge& edge : edges) times_[edge.kind].push_back(edge.time_s);
  }
  /// From this edge to the nearest of its kind; infinity if there is none.
  [[nodiscard]] double toNearest_s(const TimedEdge& edge) const {
    const auto found = times_.find(edge.kind);
    if (found == times_.end()) return std::numeric_limits<double>::infinity();
    const auto after = std::ranges::lower_bound(found->second, edge.time_s);
    double nearest_s = std::numeric_limits<double>::infinity();
    if (after != found->second.end()) nearest_s = *after - edge.time_s;
    if (after != found->second.begin() && edge.time_s - *(after - 1) < nearest_s)
      nearest_s = *(after - 1) - edge.time_s;
    return nearest_s;
  }

 private:
  std::map<Kind, std::vector<double>> times_;
};

/// Lags of one signal.
struct Strays {
  std::size_t edges{};
  std::size_t astray{};
  double first_s{};
  double worst_s{};  ///< Worst lag of those that have one of their kind at all.
};
using StraysOf = std::map<Signal, Strays>;

double limitOf_s(Signal signal, double limit_s) {
  return source::answersToPins(signal)
             ? limit_s + kLimitSwitch_s + 1e-9 * static_cast<double>(source::GpioLiveSource::kHoldBack_ns)
             : limit_s;
}

StraysOf straysOf(const std::vector<TimedEdge>& edges, const EdgeIndex& others, double end_s, double limit_s,
                  SensorLag* lag) {
  StraysOf strays;
  for (const TimedEdge& edge : edges) {
    const Signal signal = std::get<Signal>(edge.kind);
    const double allowed_s = limitOf_s(signal, limit_s);
    if (edge.time_s > end_s - allowed_s) continue;
    Strays& of_signal = strays[signal];
    ++of_signal.edges;
    const double off_s = others.toNearest_s(edge);
    if (std::isfinite(off_s) && lag != nullptr)
      (source::answersToPins(signal) ? lag->switch_lag : lag->lag)
          .add(std::llround(1e9 * off_s), static_cast<std::uint64_t>(std::llround(1e9 * edge.time_s)));
    if (std::abs(off_s) <= allowed_s) continue;
    if (of_signal.astray++ == 0) of_signal.first_s = edge.time_s;
    if (std::isfinite(off_s)) of_signal.worst_s = std::max(of_signal.worst_s, std::abs(off_s));
  }
  return strays;
}

std::string nameFor(Signal signal) { return isEncoder(signal) ? "encoder" : std::string(signalName(signal)); }

void tell(const StraysOf& all, const char* what, double limit_s, SensorLag& result) {
  for (const auto& [signal, strays] : all) {
    if (strays.astray == 0) continue;
    std::string words =
        fmt::format("{}: {} of {} edges {} {:.4g} us, the first at {:.6f} s", nameFor(signal), strays.astray,
                    strays.edges, what, 1e6 * limitOf_s(signal, limit_s), strays.first_s);
    if (strays.worst_s > 0.0) words += fmt::format(", by up to {:.4g} us", 1e6 * strays.worst_s);
    (signal == Signal::kInterlock ? result.guard_problems : result.problems).push_back(std::move(words));
  }
}

}  // namespace

SensorLag sensorLag(std::span<const SensorEdge> due, std::span<const SensorEdge> driven, TickRate rate,
                    Tick end, const std::vector<Signal>& signals, double limit_s) {
  const std::vector<TimedEdge> wanted = timedEdges(due, rate, signals);
  const std::vector<TimedEdge> put = timedEdges(driven, rate, signals);
  const double end_s = rate.seconds(end);
  SensorLag result;
  tell(straysOf(wanted, EdgeIndex(put), end_s, limit_s, &result),
       "of the machine's sensor were not driven within", limit_s, result);
  tell(straysOf(put, EdgeIndex(wanted), end_s, limit_s, nullptr),
       "that were driven are not the machine's within", limit_s, result);
  return result;
}

double sensorLagLimit_s(const scenario::Scenario& scenario) {
  if (scenario.firmware.gpio.max_lag_s) return *scenario.firmware.gpio.max_lag_s;
  double fastest_mm_s = std::abs(scenario.belt_speed_mm_s);
  for (const twin::SpeedPoint& point : scenario.belt_speed_changes)
    fastest_mm_s = std::max(fastest_mm_s, std::abs(point.speed_mm_s));
  return fastest_mm_s > 0.0 ? std::clamp(kOnSheet_mm / fastest_mm_s, 1e-6, 1e-3) : 1e-3;
}

}  // namespace kerfbench::run
