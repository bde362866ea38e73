// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/real_time.h"

namespace kerfbench::hil {
namespace {

constexpr TickRate kNanoseconds{1, 1'000'000'000};
constexpr Tick kLead = kNanoseconds.ticksAt(kLeadBeforeEdges_s);
constexpr Tick kTail = kNanoseconds.ticksAt(kTailAfterEdges_s);
constexpr int kWait_ms = 10;

std::uint64_t nanoseconds(double time_s) { return static_cast<std::uint64_t>(std::ceil(1e9 * time_s)); }

class Capture {
 public:
  Capture(const GpioCaptureOptions& options, const SignalMap& map, std::shared_ptr<GpioSystem> system)
      : options_(options),
        map_(map),
        system_(std::move(system)),
        request_(system_, options.chip, wishes()),
        levels_(request_.levels()),
        begin_ns_(system_->now_ns()),
        order_(levels_, begin_ns_) {}

  PinCapture run() {
    checkStart();
    const bool quiet = listen();
    order_.takeAll(edges_);
    if (quiet) compareLevels();
    tellFaults();
    record();
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::vector<LineWish> wishes() const {
    std::vector<LineWish> wishes;
    for (const GpioWire& wire : options_.wires) {
      if (!map_.pin(wire.signal) || isSensor(wire.signal))
        throw std::invalid_argument("a wire for a signal that is no output of the machine's");
      wishes.push_back({wire.offset, std::string(signalName(wire.signal))});
    }
    return wishes;
  }

  void checkStart() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (levels_[i] &&
          std::ranges::find(options_.low_at_start, options_.wires[i].signal) != options_.low_at_start.end())
        problem(highAtStartWords(request_.lines()[i].name));
    }
  }

  /// True: the pins have come to rest.
  bool listen() {
    std::vector<KernelEdge> read;
    std::uint64_t last_ns = begin_ns_;
    bool any = false;
    for (;;) {
      const std::uint64_t before_ns = system_->now_ns();
      if (any && before_ns - last_ns >= nanoseconds(options_.quiet_s)) return true;
      if (before_ns - begin_ns_ >= nanoseconds(options_.time_limit_s)) return problem(timeLimitWords(options_.time_limit_s, any));
      if (edges_.size() > kMostCapturedEdges) return problem(kTooManyEdgesWords);
      try {
        request_.read(kWait_ms, read);
      } catch (const GpioError& e) {
        return problem(e.what());
      }
      const std::uint64_t now_ns = system_->now_ns();
      if (!read.empty()) {
        any = true;
        last_ns = now_ns;
      }
      order_.add(read, now_ns);
      read.clear();
      if (now_ns - begin_ns_ > EdgeOrder::kHold_ns) order_.take(now_ns, now_ns - EdgeOrder::kHold_ns, edges_);
    }
  }

  /// A second way to know that no edge was lost: where the last edge leaves each line, there it is.
  void compareLevels() {
    try {
      const std::vector<bool> now = request_.levels();
      for (std::size_t i = 0; i < now.size(); ++i) {
        if (now[i] == order_.levels()[i]) continue;
        problem(fmt::format("{} is {} in the end, and its edges say {}: an odd number of them was lost",
                            request_.lines()[i].name, now[i] ? "high" : "low", now[i] ? "low" : "high"));
      }
    } catch (const GpioError& e) {
      problem(e.what());
    }
  }

  void tellFaults() {
    const std::vector<std::string> faults = order_.problems();
    for (const std::string& fault : faults) problem(fault);
    if (faults.empty() || order_.faults().first_ns <= begin_ns_) return;
    result_.recording.problems.back() += fmt::format(" (the first trouble with edges is {:.6f} s after the start)",
                                           1e-9 * static_cast<double>(order_.faults().first_ns - begin_ns_));
  }

  void record() {
    PinRecording& recording = result_.recording;
    recording.rate = kNanoseconds;
    recording.stamp_err_ticks = static_cast<std::uint32_t>(nanoseconds(options_.stamp_err_s));
    result_.edges = edges_.size();
    // Tick 0 has no levels of its own and tick 1 those at the start; the first edge comes later than both.
    std::uint64_t origin_ns = begin_ns_ - 1;
    if (!edges_.empty() && edges_.front().stamp_ns > origin_ns + kLead)
      origin_ns = edges_.front().stamp_ns - kLead;
    recordStart();
    for (const LineEdge& edge : edges_) recordEdge(edge, edge.stamp_ns - origin_ns);
    recording.end = edges_.empty() ? kTail : edges_.back().stamp_ns - origin_ns + kTail;
    // A replay has to know as well.
    if (!recording.problems.empty()) {
      const std::uint16_t port = pinOf(0).port;
      recording.outputs.push_back({recording.end, port, 0, port_levels_[port], PinEvent::kGap});
    }
  }

  void recordStart() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (!levels_[i]) continue;
      port_levels_[pinOf(i).port] |= maskOf(i);
    }
    for (const auto& [port, level] : port_levels_)
      result_.recording.outputs.push_back({1, port, level, level, PinEvent::kNone});
  }

  /// Edges of one port at one stamp are one event, as in any recording.
  void recordEdge(const LineEdge& edge, Tick tick) {
    auto& outputs = result_.recording.outputs;
    const PinId pin = pinOf(edge.line);
    std::uint16_t& level = port_levels_[pin.port];
    const std::uint16_t changed = edge.changed ? maskOf(edge.line) : std::uint16_t{0};
    level ^= changed;
    PinEvent* event = nullptr;
    for (auto it = outputs.rbegin(); it != outputs.rend() && it->tick == tick; ++it) {
      if (it->port == pin.port) event = &*it;
    }
    if (event == nullptr) event = &outputs.emplace_back(PinEvent{tick, pin.port, 0, level, PinEvent::kNone});
    event->changed |= changed;
    event->level = level;
    if (edge.gap) event->flags |= PinEvent::kGap;
  }

  [[nodiscard]] PinId pinOf(std::size_t line) const { return *map_.pin(options_.wires[line].signal); }
  [[nodiscard]] std::uint16_t maskOf(std::size_t line) const {
    return static_cast<std::uint16_t>(1U << pinOf(line).bit);
  }
  bool problem(std::string words) {
    result_.recording.problems.push_back(std::move(words));
    return false;
  }

  const GpioCaptureOptions& options_;
  const SignalMap& map_;
  std::shared_ptr<GpioSystem> system_;
  LineRequest request_;
  std::vector<bool> levels_;
  std::uint64_t begin_ns_;
  EdgeOrder order_;
  std::vector<LineEdge> edges_;
  std::map<std::uint16_t, std::uint16_t> port_levels_;
  PinCapture result_;
};

}  // namespace

PinCapture capturePins(const GpioCaptureOptions& options, const SignalMap& map,
                       const std::shared_ptr<GpioSystem>& system) {
  const RealTime real_time(system);
  PinCapture result = Capture(options, map, system).run();
  result.notes = real_time.notes();
  return result;
}

}  // namespace kerfbench::hil
