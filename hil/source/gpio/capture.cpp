// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/line_levels.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/nanoseconds.h"
#include "hil/source/gpio/port_events.h"
#include "hil/source/gpio/real_time.h"

namespace kerfbench::source {
namespace {

constexpr Tick kLead = kNanoseconds.ticksAt(kLeadBeforeEdges_s);
constexpr Tick kTail = kNanoseconds.ticksAt(kTailAfterEdges_s);
constexpr std::chrono::milliseconds kWait{10};

class Capture {
 public:
  Capture(const GpioCaptureOptions& options, const SignalMap& map, std::shared_ptr<GpioSystem> system)
      : options_(options),
        map_(map),
        system_(std::move(system)),
        request_(system_, options.chip, chipLinesOf(options.wires, map, false)),
        levels_(request_.levels()),
        begin_ns_(system_->now_ns()),
        order_(levels_, begin_ns_) {}

  PinCapture run() {
    problems(wrongAtStart(options_.wires, levels_, options_.at_start));
    const bool quiet = listen();
    order_.takeAll(edges_);
    if (quiet) problems(levelsAgainstEdges(request_, order_));
    problems(edgeTroubles(order_, begin_ns_));
    record();
    return std::move(result_);
  }

 private:
  /// True: the pins have come to rest.
  bool listen() {
    std::vector<KernelEdge> read;
    std::uint64_t last_ns = begin_ns_;
    bool any = false;
    for (;;) {
      const std::uint64_t before_ns = system_->now_ns();
      if (any && before_ns - last_ns >= nanosecondsUp(options_.quiet_s)) return true;
      if (before_ns - begin_ns_ >= nanosecondsUp(options_.time_limit_s))
        return problem(timeLimitWords(options_.time_limit_s, any));
      if (edges_.size() > kMostCapturedEdges) return problem(kTooManyEdgesWords);
      try {
        request_.read(kWait, read);
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
      if (now_ns - begin_ns_ <= EdgeOrder::kHold_ns) continue;
      const std::size_t known = edges_.size();
      order_.take(now_ns, now_ns - EdgeOrder::kHold_ns, edges_);
      if (options_.heard) options_.heard(now_ns - begin_ns_, std::span(edges_).subspan(known));
    }
  }

  void record() {
    PinRecording& recording = result_.recording;
    recording.rate = kNanoseconds;
    recording.stamp_err_ticks = static_cast<std::uint32_t>(nanosecondsUp(options_.stamp_err_s));
    result_.edges = edges_.size();
    // Tick 0 has no levels of its own and tick 1 those at the start; the first edge comes later than both.
    std::uint64_t origin_ns = begin_ns_ - 1;
    if (!edges_.empty() && edges_.front().stamp_ns > origin_ns + kLead)
      origin_ns = edges_.front().stamp_ns - kLead;
    PortEvents ports(pinsOf(options_.wires, map_));
    std::vector<PinEvent> instant;
    ports.start(levels_, 1, instant);
    for (const LineEdge& edge : edges_) {
      const Tick tick = edge.stamp_ns - origin_ns;
      if (!instant.empty() && instant.back().tick != tick) {
        recording.outputs.append(instant);
        instant.clear();
      }
      ports.add(edge, tick, instant);
    }
    recording.outputs.append(instant);
    recording.end = edges_.empty() ? kTail : edges_.back().stamp_ns - origin_ns + kTail;
    spoilEnd(recording, pinsOf(options_.wires, map_).front().port);
  }

  void problems(const std::vector<std::string>& words) {
    for (const std::string& sentence : words) problem(sentence);
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

}  // namespace kerfbench::source
