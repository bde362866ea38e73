// SPDX-License-Identifier: Apache-2.0
#include "hil/run/sensor_lag.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "hil/source/encoder_edges.h"
#include "hil/source/gpio/live_source.h"

namespace kerfbench::run {
namespace {

constexpr double kOnSheet_mm = 0.01;
// Step of the model of the gantry, behind the hold-back.
constexpr double kLimitSwitch_s = 0.005;

struct Kind {
  Signal signal{};
  bool high{};  ///< Level; of the encoder's edges: forwards.
  long long counts{};
  friend auto operator<=>(const Kind&, const Kind&) = default;
};

struct TimedEdge {
  double time_s{};
  Kind kind;
};

bool isEncoder(Signal signal) { return signal == Signal::kEncoderA || signal == Signal::kEncoderB; }

using SensorEdges = base::SpilledVector<SensorEdge>;
using TimedEdges = base::SpilledVector<TimedEdge>;

bool isByTick(const SensorEdges& edges) {
  Tick last = 0;
  return std::ranges::all_of(
      edges.streamed(), [&](const SensorEdge& edge) { return std::exchange(last, edge.tick) <= edge.tick; });
}

/// Edges of live pins are put out at their times, those of limit switches when they are known.
SensorEdges byTick(const SensorEdges& edges) {
  if (isByTick(edges)) return edges;
  std::vector<SensorEdge> sorted(edges.begin(), edges.end());
  std::ranges::stable_sort(sorted, {}, &SensorEdge::tick);
  return SensorEdges(sorted);
}

/// Edges sorted by time; of one instant those of the encoder first.
TimedEdges timedEdges(const SensorEdges& edges, TickRate rate, const std::vector<Signal>& signals) {
  TimedEdges timed;
  std::vector<TimedEdge> instant;
  source::EncoderCounter encoder(rate);
  long long before = 0;
  const SensorEdges sorted = byTick(edges);
  for (const SensorEdge& edge : sorted.streamed()) {
    if (std::ranges::find(signals, edge.signal) == signals.end()) continue;
    const double time_s = rate.seconds(edge.tick);
    if (!instant.empty() && instant.front().time_s != time_s) {
      timed.append(instant);
      instant.clear();
    }
    if (!isEncoder(edge.signal)) instant.push_back({time_s, {edge.signal, edge.level, 0}});
    if (const auto counted = encoder.take(edge)) {
      timed.push_back({time_s, {Signal::kEncoderA, counted->counts > before, counted->counts}});
      before = counted->counts;
    }
  }
  timed.append(instant);
  return timed;
}

/// Times of edges, by kind. A belt that runs comes to a new count with nearly every edge: these are a row of
/// times by count for each direction, and what comes to a count again is few.
class EdgeIndex {
 public:
  explicit EdgeIndex(const TimedEdges& edges) {
    for (const TimedEdge& edge : edges.streamed()) {
      base::SpilledVector<double>* const row = rowOf(edge.kind);
      if (row != nullptr && placeOf(edge.kind) == row->size()) {
        row->push_back(edge.time_s);
      } else {
        others_[edge.kind].push_back(edge.time_s);
      }
    }
  }
  /// From this edge to the nearest of its kind; infinity if there is none.
  [[nodiscard]] double toNearest_s(const TimedEdge& edge) const {
    std::optional<double> before_s;
    std::optional<double> after_s;
    const auto see = [&](double time_s) {
      if (time_s < edge.time_s) {
        before_s = std::max(before_s.value_or(time_s), time_s);
      } else {
        after_s = std::min(after_s.value_or(time_s), time_s);
      }
    };
    const base::SpilledVector<double>* const row = rowOf(edge.kind);
    if (row != nullptr && placeOf(edge.kind) < row->size()) see((*row)[placeOf(edge.kind)]);
    if (const auto found = others_.find(edge.kind); found != others_.end()) {
      const auto after = std::ranges::lower_bound(found->second, edge.time_s);
      if (after != found->second.end()) see(*after);
      if (after != found->second.begin()) see(*(after - 1));
    }
    double nearest_s = std::numeric_limits<double>::infinity();
    if (after_s) nearest_s = *after_s - edge.time_s;
    if (before_s && edge.time_s - *before_s < nearest_s) nearest_s = *before_s - edge.time_s;
    return nearest_s;
  }
  /// Gives memory back, to be called now and then.
  void giveBack() const {
    for (const auto& row : rows_) row.giveBack(0, row.size());
  }

 private:
  /// Null where the count is not one that such edges come to from the start on.
  static std::optional<std::size_t> rowIndexOf(const Kind& kind) {
    if (kind.signal != Signal::kEncoderA || (kind.high ? kind.counts < 1 : kind.counts > -1))
      return std::nullopt;
    return kind.high ? 0U : 1U;
  }
  [[nodiscard]] const base::SpilledVector<double>* rowOf(const Kind& kind) const {
    const auto index = rowIndexOf(kind);
    return index ? &rows_.at(*index) : nullptr;
  }
  base::SpilledVector<double>* rowOf(const Kind& kind) {
    const auto index = rowIndexOf(kind);
    return index ? &rows_.at(*index) : nullptr;
  }
  static std::size_t placeOf(const Kind& kind) { return static_cast<std::size_t>(std::abs(kind.counts) - 1); }

  std::array<base::SpilledVector<double>, 2> rows_;  ///< First times, forwards 1, 2, … and back -1, -2, …
  std::map<Kind, std::vector<double>> others_;
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

StraysOf straysOf(const TimedEdges& edges, const EdgeIndex& others, double end_s, double limit_s,
                  SensorLag* lag) {
  StraysOf strays;
  std::size_t looked_up = 0;
  for (const TimedEdge& edge : edges.streamed()) {
    if (++looked_up % TimedEdges::kStride == 0) others.giveBack();
    const Signal signal = edge.kind.signal;
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

SensorLag sensorLag(const SensorEdges& due, const SensorEdges& driven, TickRate rate, Tick end,
                    const std::vector<Signal>& signals, double limit_s) {
  const TimedEdges wanted = timedEdges(due, rate, signals);
  const TimedEdges put = timedEdges(driven, rate, signals);
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
