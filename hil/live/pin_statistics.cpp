// SPDX-License-Identifier: Apache-2.0
#include "hil/live/pin_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>

namespace kerfbench::live {
namespace {

constexpr double kPeakWindow_s = 1e-3;

/// The ticks of one line's edges; a recording may be long, so only those of the last millisecond are kept.
class LineEar {
 public:
  LineEar(Signal signal, TickRate rate) : rate_(rate), line_{.signal = signal} {}

  void edge(Tick tick) {
    if (last_) line_.shortest_s = std::min(line_.shortest_s, rate_.seconds(tick - *last_));
    last_ = tick;
    ++line_.edges;
    recent_.push_back(tick);
    while (rate_.seconds(tick - recent_.front()) >= kPeakWindow_s) recent_.pop_front();
    line_.peak_hz = std::max(line_.peak_hz, static_cast<double>(recent_.size()) / kPeakWindow_s);
  }
  [[nodiscard]] const LineStatistics& line() const { return line_; }

 private:
  TickRate rate_;
  LineStatistics line_;
  std::optional<Tick> last_;
  std::deque<Tick> recent_;
};

}  // namespace

PinStatistics pinStatistics(const source::PinRecording& recording, const SignalMap& map) {
  std::vector<std::pair<PinId, LineEar>> ears;
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    if (const auto pin = map.pin(signal); map.hasOwnWire(signal) && !isSensor(signal))
      ears.emplace_back(*pin, LineEar(signal, recording.rate));
  }
  PinStatistics heard;
  std::optional<Tick> first;
  Tick last = 0;
  for (const PinEvent& event : recording.outputs) {
    // The levels at the start, and marks of gaps: no edges. (See capturePins().)
    if (event.changed == 0 || event.tick <= 1) continue;
    bool any = false;
    for (auto& [pin, ear] : ears) {
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      ear.edge(event.tick);
      any = true;
    }
    if (!any) continue;
    if (!first) first = last = event.tick;
    heard.longest_silence_s = std::max(heard.longest_silence_s, recording.rate.seconds(event.tick - last));
    last = event.tick;
  }
  if (first) heard.span_s = recording.rate.seconds(last - *first);
  for (const auto& [pin, ear] : ears) {
    heard.lines.push_back(ear.line());
    heard.edges += ear.line().edges;
  }
  return heard;
}

std::string pinStatisticsText(const PinStatistics& heard) {
  std::string text;
  for (const LineStatistics& line : heard.lines) {
    text += fmt::format("  {:<14} {:>10} edges", signalName(line.signal), line.edges);
    if (line.edges >= 2)
      text += fmt::format(", at most {:.0f} per second, two within {:.4g} us", line.peak_hz,
                          1e6 * line.shortest_s);
    text += "\n";
  }
  return text + fmt::format("  {} edges in {:.3f} s, the longest silence among them {:.3f} s", heard.edges,
                            heard.span_s, heard.longest_silence_s);
}

}  // namespace kerfbench::live
