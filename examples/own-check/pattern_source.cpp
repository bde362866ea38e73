// SPDX-License-Identifier: Apache-2.0
#include "pattern_source.h"

#include <stdexcept>

namespace own {
namespace {

using namespace kerfbench;

constexpr TickRate kRate{1, 1'000'000};  // A tick is a microsecond.
constexpr double kStart_s = 0.02;
constexpr double kPeriod_s = 200e-6;  // One step; half of it PUL is high.
constexpr int kSteps = 200;           // Each way.

}  // namespace

void PatternSource::toggle(Signal signal, double time_s) {
  const std::optional<PinId> pin = map_.pin(signal);
  if (!pin) throw std::invalid_argument("the machine has no " + std::string(signalName(signal)));
  if (levels_.size() <= pin->port) levels_.resize(pin->port + 1U);
  const auto bit = static_cast<std::uint16_t>(1U << pin->bit);
  levels_[pin->port] ^= bit;
  events_.push_back({kRate.ticksAt(time_s), pin->port, bit, levels_[pin->port], PinEvent::kNone});
}

PatternSource::PatternSource(const SignalMap& map, double rest_s) : map_(map) {
  const bool has_mirrors = map.pin(Signal::kGalvoXPul).has_value();
  const Signal pul = has_mirrors ? Signal::kGalvoXPul : Signal::kGantryXPul;
  const Signal dir = has_mirrors ? Signal::kGalvoXDir : Signal::kGantryXDir;
  double now_s = kStart_s;
  toggle(Signal::kLaserPwm, now_s);
  toggle(Signal::kLaserGate, now_s);
  for (const bool back : {false, true}) {
    // DIR long before PUL, as every drive wants it.
    if (back) toggle(dir, now_s);
    for (int i = 0; i < kSteps; ++i) {
      now_s += kPeriod_s / 2;
      toggle(pul, now_s);
      now_s += kPeriod_s / 2;
      toggle(pul, now_s);
    }
    if (!back) now_s += rest_s;
  }
  toggle(Signal::kLaserGate, now_s + kPeriod_s / 2);
}

source::SourceInfo PatternSource::info() const {
  return {.rate = kRate, .deterministic = true, .config_id = "own pattern"};
}

source::Stop PatternSource::advance(Tick until, source::Batch& batch) {
  batch = {};
  for (; next_ < events_.size() && events_[next_].tick <= until; ++next_)
    batch.events.push_back(events_[next_]);
  batch.watermark = batch.uart_received = until;
  return next_ < events_.size() ? source::Stop::kReached : source::Stop::kEnded;
}

}  // namespace own
