// SPDX-License-Identifier: Apache-2.0
#include "hil/live/pin_watch.h"

#include <algorithm>
#include <chrono>
#include <system_error>

namespace kerfbench::live {
namespace {

constexpr std::chrono::milliseconds kBetweenWatched{250};

}  // namespace

PinWatch::PinWatch(const SignalMap& map, TickRate rate, base::EventLog* log) : log_(log), rate_(rate) {
  if (log_ == nullptr) return;
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    if (const auto pin = map.pin(signal); pin && map.hasOwnWire(signal) && !isSensor(signal))
      lines_.push_back({signal, *pin, 0});
  }
  thread_ = std::thread([this] { work(); });
}

PinWatch::~PinWatch() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void PinWatch::count(std::size_t line, bool level) {
  edges_.at(line).fetch_add(1, std::memory_order_relaxed);
  levels_.at(line).store(level, std::memory_order_relaxed);
}

void PinWatch::heard(Tick until, std::span<const PinEvent> events) {
  if (log_ == nullptr) return;
  for (const PinEvent& event : events) {
    if ((event.flags & PinEvent::kGap) != 0) lost_.store(true, std::memory_order_relaxed);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const PinId pin = lines_[i].pin;
      if (pin.port != event.port) continue;
      const bool level = (event.level >> pin.bit & 1U) != 0;
      // Tick 1 has the levels at the start.
      if (event.tick <= 1)
        levels_.at(i).store(level, std::memory_order_relaxed);
      else if ((event.changed >> pin.bit & 1U) != 0)
        count(i, level);
    }
  }
  now_s_.store(rate_.seconds(until), std::memory_order_relaxed);
}

void PinWatch::heard(std::uint64_t now_ns, std::span<const source::LineEdge> edges,
                     const std::vector<source::GpioWire>& wires) {
  if (log_ == nullptr) return;
  for (const source::LineEdge& edge : edges) {
    if (edge.gap) lost_.store(true, std::memory_order_relaxed);
    const Signal signal = wires.at(edge.line).signal;
    const auto line = std::ranges::find(lines_, signal, &Line::signal);
    if (line != lines_.end() && edge.changed)
      count(static_cast<std::size_t>(line - lines_.begin()), edge.level);
  }
  now_s_.store(1e-9 * static_cast<double>(now_ns), std::memory_order_relaxed);
}

void PinWatch::work() {
  std::unique_lock lock(mutex_);
  for (bool is_last = false; !is_last;) {
    is_last = changed_.wait_for(lock, kBetweenWatched, [this] { return ending_; });
    try {
      tell();
    } catch (const std::system_error&) {
      return;  // A disk that is full: who watches sees no more, and the run goes on.
    }
  }
}

void PinWatch::tell() {
  const double now_s = now_s_.load(std::memory_order_relaxed);
  const double since_s = now_s - told_s_;
  told_s_ = now_s;
  std::vector<std::string> signals;
  std::vector<std::int64_t> edges, per_s, levels;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::uint64_t count = edges_.at(i).load(std::memory_order_relaxed);
    const auto more = static_cast<double>(count - lines_[i].told);
    lines_[i].told = count;
    signals.emplace_back(signalName(lines_[i].signal));
    edges.push_back(static_cast<std::int64_t>(count));
    per_s.push_back(since_s > 0.0 ? static_cast<std::int64_t>(more / since_s) : 0);
    levels.push_back(levels_.at(i).load(std::memory_order_relaxed) ? 1 : 0);
  }
  log_->tell("pins", {{"now_s", now_s},
                      {"signals", std::move(signals)},
                      {"edges", std::move(edges)},
                      {"edges_per_s", std::move(per_s)},
                      {"levels", std::move(levels)},
                      {"worst_lag_us", 1e-3 * static_cast<double>(lag_ns_.load(std::memory_order_relaxed))}});
  if (lost_.load(std::memory_order_relaxed) && !told_lost_) {
    told_lost_ = true;
    log_->tell("problem", {{"text", "Edges were lost on the way from the pins: the run will be INVALID."}});
  }
}

}  // namespace kerfbench::live
