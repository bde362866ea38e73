// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/pulse_counter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace kerfbench::controller {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// On the wire a KB_STATE follows its ACK, and perhaps an EVENT. The belt in it is that of the last border of
// a period (0.8 ms), the main loop may be a period behind, and the bench looks every 0.5 ms. What a real line
// adds is the scenario's to say.
constexpr double kStateBits = 34 * 10;
constexpr double kBitsBefore = 16 * 10;
constexpr double kControllerBehind_s = 3e-3;

// The order of KB_STATE.
constexpr std::array<Signal, UartListener::kAxes> kPuls{
    Signal::kGalvoXPul, Signal::kGalvoYPul, Signal::kGantryXPul, Signal::kGantryYPul, Signal::kFeedPul};

Signal dirOf(Signal pul) { return static_cast<Signal>(static_cast<std::size_t>(pul) + 1); }

}  // namespace

std::string axisNameOf(Signal pul) {
  std::string name(signalName(pul));
  name.resize(name.size() - std::string_view("_pul").size());
  return name;
}

bool PulseCounter::Axis::take(const PinEvent& event) {
  if (event.port == dir_pin.port) dir = (event.level >> dir_pin.bit & 1U) != 0;
  if (enable_pin && event.port == enable_pin->port)
    enabled = drive.enabledBy((event.level >> enable_pin->bit & 1U) != 0);
  const bool changes = event.port == pul_pin.port && (event.changed >> pul_pin.bit & 1U) != 0;
  const bool high = (event.level >> pul_pin.bit & 1U) != 0;
  if (!changes || high != drive.active_edge_rising || !enabled) return false;
  net += drive.senseOf(dir);
  return true;
}

void PulseCounter::Axis::restart() {
  dir = false;
  enabled = !enable_pin || drive.enabledBy(false);
  net = 0;
}

template <class Take>
void PulseCounter::forEachPulse(Axis axis, Take take) const {
  axis.restart();
  for (const PinEvent& event : outputs_) {
    if (axis.take(event) && !take(event.tick, axis.net)) return;
  }
}

PulseCounter::PulseCounter(const source::PinRecording& recording, const SignalMap& map,
                           std::span<const DriveOfPul> drives)
    : rate_(recording.rate), outputs_(recording.outputs) {
  for (const Signal signal : kPuls) {
    const auto pul = map.pin(signal);
    const auto dir = map.pin(dirOf(signal));
    if (!pul || !dir) continue;
    const auto drive = std::ranges::find(drives, signal, &DriveOfPul::first);
    axes_.push_back({signal, *pul, *dir, map.pin(enableOf(signal)),
                     drive == drives.end() ? DriverProfile{} : drive->second});
    axes_.back().restart();
  }
  std::optional<Tick> last;
  for (const PinEvent& event : outputs_) {
    for (Axis& axis : axes_) {
      if (axis.take(event)) last = event.tick;
    }
  }
  if (last) last_pulse_s_ = rate_.seconds(*last);
  belt_ = source::encoderEdges(recording.sensors, recording.rate);
  belt_wired_ = map.pin(Signal::kEncoderA) && map.pin(Signal::kEncoderB);
}

long long PulseCounter::beltCountsAt(double time_s) const {
  const auto next = std::ranges::upper_bound(belt_, time_s, {}, &source::EncoderEdge::time_s);
  return next == belt_.begin() ? 0 : (next - 1)->counts;
}

std::pair<long long, long long> PulseCounter::beltAround(const UartListener::BeltWord& word,
                                                         const UartTiming& uart) const {
  const double to_s = word.time_s - kStateBits / uart.baud;
  const double from_s = to_s - kBitsBefore / uart.baud - kControllerBehind_s - uart.read_delay_s;
  long long low = beltCountsAt(from_s);
  long long high = low;
  auto edge = std::ranges::upper_bound(belt_, from_s, {}, &source::EncoderEdge::time_s);
  for (; edge != belt_.end() && edge->time_s <= to_s; ++edge) {
    low = std::min(low, edge->counts);
    high = std::max(high, edge->counts);
  }
  return {low, high};
}

std::optional<long long> PulseCounter::net(Signal pul) const {
  const auto axis = std::ranges::find(axes_, pul, &Axis::pul);
  return axis == axes_.end() ? std::nullopt : std::optional(axis->net);
}

double PulseCounter::pulse_s(Signal pul, long long count) const {
  const auto axis = std::ranges::find(axes_, pul, &Axis::pul);
  double time_s = kNan;
  if (axis == axes_.end() || count < 1) return time_s;
  forEachPulse(*axis, [&](Tick tick, long long /*place*/) {
    if (--count > 0) return true;
    time_s = rate_.seconds(tick);
    return false;
  });
  return time_s;
}

double PulseCounter::leaves_s(Signal pul, long long low, long long high) const {
  const auto axis = std::ranges::find(axes_, pul, &Axis::pul);
  double time_s = kNan;
  if (axis == axes_.end()) return time_s;
  forEachPulse(*axis, [&](Tick tick, long long place) {
    if (place >= low && place <= high) return true;
    time_s = rate_.seconds(tick);
    return false;
  });
  return time_s;
}

double PulseCounter::beltFaster_s(double counts_per_s, double span_s) const {
  for (const source::EncoderEdge& edge : belt_.streamed()) {
    if (edge.time_s < span_s) continue;
    const long long moved = edge.counts - beltCountsAt(edge.time_s - span_s);
    if (static_cast<double>(moved) > counts_per_s * span_s + 1.0) return edge.time_s;
  }
  return kNan;
}

inspect::ControllerAccount PulseCounter::compareWithReport(const std::optional<UartListener::Account>& report,
                                                           const UartTiming& uart) const {
  inspect::ControllerAccount account;
  account.told = report.has_value();
  if (!report) return account;
  for (const Axis& axis : axes_) {
    const auto index = static_cast<std::size_t>(std::ranges::find(kPuls, axis.pul) - kPuls.begin());
    account.axes.push_back({axisNameOf(axis.pul), report->steps[index], axis.net});
  }
  if (belt_wired_ && report->first_belt.time_s < report->belt.time_s) {
    const auto [first_min, first_max] = beltAround(report->first_belt, uart);
    const auto [last_min, last_max] = beltAround(report->belt, uart);
    account.belt = {report->belt.counts - report->first_belt.counts, last_min - first_max,
                    last_max - first_min};
  }
  return account;
}

}  // namespace kerfbench::controller
