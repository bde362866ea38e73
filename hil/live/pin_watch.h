// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "hil/base/event_log.h"
#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/wires.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::live {

/// Tells those who watch a run on real pins how it goes, four times a second and when it ends: event `pins`,
/// and `problem` as soon as edges were lost. A thread of its own does it, because a write may take longer
/// than a quantum; whoever reads the pins only counts, and never waits. Nothing is judged by it.
class PinWatch {
 public:
  /// `log` may be null: nobody watches, and nothing is counted. It must outlive this.
  PinWatch(const SignalMap& map, TickRate rate, base::EventLog* log);
  ~PinWatch();
  PinWatch(const PinWatch&) = delete;
  PinWatch& operator=(const PinWatch&) = delete;

  [[nodiscard]] bool isWatched() const { return log_ != nullptr; }
  /// Edges of the controller's outputs up to `until`.
  void heard(Tick until, std::span<const PinEvent> events);
  /// The same as lines of a chip, `now_ns` after the begin.
  void heard(std::uint64_t now_ns, std::span<const source::LineEdge> edges,
             const std::vector<source::GpioWire>& wires);
  /// Worst lag so far of the edges that the bench drives.
  void lagged(std::uint64_t worst_ns) { lag_ns_.store(worst_ns, std::memory_order_relaxed); }

 private:
  struct Line {
    Signal signal{};
    PinId pin{};
    std::uint64_t told{};  ///< Edges when they were told the last time; the thread's own.
  };
  void work();
  void tell();
  void count(std::size_t line, bool level);

  base::EventLog* log_;
  TickRate rate_;
  std::vector<Line> lines_;
  std::array<std::atomic<std::uint64_t>, kSignalCount> edges_{};
  std::array<std::atomic<bool>, kSignalCount> levels_{};
  std::atomic<double> now_s_{0.0};
  std::atomic<std::uint64_t> lag_ns_{0};
  std::atomic<bool> lost_{false};
  double told_s_{};
  bool told_lost_{};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_{};
  std::thread thread_;
};

}  // namespace kerfbench::live
