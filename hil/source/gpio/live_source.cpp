// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/live_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "hil/source/gpio/line_levels.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kRoom = std::size_t{1} << 20U;  // Edges.

/// A vector that grows copies what it has while edges are due, and memory that nobody has touched yet is
/// none: only what is there when it is locked (RealTime) is locked.
std::vector<PlayedEdge> touchedRoom(std::size_t edges) {
  std::vector<PlayedEdge> room(edges);
  room.clear();
  return room;
}

std::vector<bool> levelsAtStart(const GpioLiveOptions& options) {
  std::vector<bool> levels;
  for (const GpioWire& wire : options.out)
    levels.push_back(std::ranges::find(options.high_at_start, wire.signal) != options.high_at_start.end());
  return levels;
}

}  // namespace

GpioLiveSource::GpioLiveSource(const GpioLiveOptions& options, const SignalMap& map,
                               std::shared_ptr<GpioSystem> system, std::unique_ptr<SerialLine> uart)
    : options_(options),
      system_(std::move(system)),
      played_(touchedRoom(options.out.empty() ? 0 : kRoom)),
      real_time_(system_),
      uart_(std::move(uart)),
      request_(system_, options.in.chip, chipLinesOf(options.in.wires, map, false)),
      ports_(pinsOf(options.in.wires, map)) {
  if (options_.out.empty()) return;
  player_.emplace(system_, OutputLines(system_, options_.out_chip, chipLinesOf(options_.out, map, true),
                                       levelsAtStart(options_)));
  const std::vector<PinId> pins = pinsOf(options_.out, map);
  for (std::size_t i = 0; i < pins.size(); ++i) out_line_.emplace(pins[i], i);
}

SourceInfo GpioLiveSource::info() const {
  return {kRate, static_cast<std::uint32_t>(nanosecondsUp(options_.in.stamp_err_s)), false, true,
          fmt::format("gpiochip {}, live", options_.in.chip.string())};
}

Stop GpioLiveSource::advance(Tick until, Batch& batch) {
  batch.events.clear();
  batch.uart.clear();
  batch.watermark = watermark_;
  batch.uart_received = uartReceived();
  if (stop_ != Stop::kReached) return stop_;
  if (until <= watermark_) throw std::invalid_argument("advance() must go forward");
  try {
    if (!begun_) begin();
    if (const std::uint64_t now_ns = system_->now_ns(); now_ns > nsOf(until) + kHoldBack_ns + kHopeless_ns) {
      return stop(Stop::kLost,
                  fmt::format("the model does not keep up with the clock: it is {:.0f} ms behind",
                              1e-6 * static_cast<double>(now_ns - nsOf(until) - kHoldBack_ns)));
    }
    runTo(nsOf(until) + kHoldBack_ns);
  } catch (const GpioError& e) {
    return stop(Stop::kLost, e.what());
  } catch (const SerialError& e) {
    return stop(Stop::kLost, e.what());
  }
  edges_.clear();
  order_->take(system_->now_ns(), nsOf(until), edges_);
  batch.events = std::exchange(start_events_, {});
  for (const LineEdge& edge : edges_) ports_.add(edge, edge.stamp_ns - origin_ns_, batch.events);
  for (; handed_bytes_ < received_.size(); ++handed_bytes_) {
    const std::vector<std::uint8_t>& bytes = received_[handed_bytes_].bytes;
    batch.uart.insert(batch.uart.end(), bytes.begin(), bytes.end());
  }
  batch.uart_received = uartReceived();
  batch.watermark = watermark_ = until;
  const bool quiet = options_.ends_when_quiet && came_ > 0 &&
                     system_->now_ns() - last_edge_ns_ >= nanosecondsUp(options_.in.quiet_s);
  return quiet ? stop(Stop::kEnded, "the pins are quiet") : Stop::kReached;
}

std::uint64_t GpioLiveSource::worstLag_ns() {
  for (; looked_at_ < played_.size(); ++looked_at_) {
    const PlayedEdge& edge = played_[looked_at_];
    if (!answersToPins(options_.out.at(edge.line).signal))
      worst_lag_ns_ = std::max(worst_lag_ns_, edge.put_ns - std::min(edge.put_ns, edge.planned_ns));
  }
  return worst_lag_ns_;
}

void GpioLiveSource::begin() {
  begun_ = true;
  const std::vector<bool> levels = request_.levels();
  start_problems_ = wrongAtStart(options_.in.wires, levels, options_.in.at_start);
  if (uart_) uart_->discard();
  begin_ns_ = system_->now_ns();
  // Tick 0 has no levels of its own and tick 1 those at the start; the first edge comes later than both.
  origin_ns_ = begin_ns_ - 1;
  order_.emplace(levels, begin_ns_);
  ports_.start(levels, 1, start_events_);
  for (const EarlyEdge& edge : before_start_) player_->plan(edge.line, edge.level, nsOf(edge.at));
  before_start_.clear();
}

void GpioLiveSource::runTo(std::uint64_t goal_ns) {
  for (;;) {
    if (player_) player_->play(played_);
    pumpUart();
    const std::uint64_t now_ns = system_->now_ns();
    if (now_ns >= goal_ns) break;
    const std::uint64_t wake_ns = player_ ? std::min(goal_ns, player_->nextDue_ns()) : goal_ns;
    readEdges(wake_ns > now_ns ? wake_ns - now_ns : 0);
  }
  // All that the kernel has by now belongs to this quantum or to later ones.
  drain(goal_ns);
}

/// Reads what the kernel has, but no more than that: of a line that oscillates there is always a new edge.
void GpioLiveSource::drain(std::uint64_t until_ns) {
  while (readEdges(0) && read_.size() == LineRequest::kMostAtOnce && read_.back().stamp_ns <= until_ns) {
  }
}

bool GpioLiveSource::readEdges(std::uint64_t timeout_ns) {
  read_.clear();
  const bool came = request_.read(std::chrono::nanoseconds(timeout_ns), read_);
  if (read_.empty()) return came;
  came_ += read_.size();
  if (came_ > options_.most_edges) throw GpioError(kTooManyEdgesWords);
  last_edge_ns_ = system_->now_ns();
  order_->add(read_, last_edge_ns_);
  return came;
}

void GpioLiveSource::pumpUart() {
  if (!uart_) return;
  std::vector<std::uint8_t> bytes;
  uart_->pump(bytes);
  if (bytes.empty()) return;
  const Tick now = system_->now_ns() - origin_ns_;
  received_.push_back({received_.empty() ? now : std::max(now, received_.back().tick + 1), std::move(bytes)});
}

void GpioLiveSource::drive(PinId pin, bool level, Tick at) {
  const auto line = out_line_.find(pin);
  if (line == out_line_.end()) return;
  if (begun_) {
    player_->plan(line->second, level, nsOf(at));
  } else {
    before_start_.push_back({line->second, level, at});
  }
}

void GpioLiveSource::uartWrite(std::span<const std::uint8_t> bytes) {
  if (uart_) uart_->write(bytes);
}

Stop GpioLiveSource::stop(Stop why, std::string message) {
  message_ = std::move(message);
  return stop_ = why;
}

GpioLiveRecord GpioLiveSource::finish(Tick end) {
  GpioLiveRecord record;
  record.notes = real_time_.notes();
  if (!begun_) return record;
  record.problems = start_problems_;
  if (stop_ == Stop::kReached || stop_ == Stop::kEnded) lookAgain(record.problems);
  const std::vector<std::string> troubles = edgeTroubles(*order_, begin_ns_);
  record.problems.insert(record.problems.end(), troubles.begin(), troubles.end());
  record.edges = order_->edges();
  if (record.edges == 0)
    record.problems.emplace_back("no edge came: is the controller wired, powered and started?");
  for (std::size_t i = 0; i < options_.out.size(); ++i) {
    const Signal signal = options_.out[i].signal;
    if (std::ranges::find(options_.high_at_start, signal) != options_.high_at_start.end())
      record.sensors.push_back({1, signal, true});
  }
  for (const PlayedEdge& edge : played_) {
    const Tick tick = edge.put_ns - origin_ns_;
    if (tick > end) break;
    const Signal signal = options_.out[edge.line].signal;
    record.sensors.push_back({tick, signal, edge.level});
    LagMeter& lag = answersToPins(signal) ? record.switch_lag : record.lag;
    lag.add(static_cast<std::int64_t>(edge.put_ns) - static_cast<std::int64_t>(edge.planned_ns), tick);
  }
  for (const ReceivedBytes& bytes : received_) {
    if (bytes.tick <= end) record.uart.push_back(bytes);
  }
  return record;
}

/// The levels are a witness only where no edge comes while they are read.
void GpioLiveSource::lookAgain(std::vector<std::string>& problems) {
  try {
    drain(system_->now_ns());
    edges_.clear();
    order_->takeAll(edges_);
    const std::vector<std::string> odd = levelsAgainstEdges(request_, *order_);
    if (!readEdges(0)) problems.insert(problems.end(), odd.begin(), odd.end());
  } catch (const GpioError& e) {
    problems.emplace_back(e.what());
  }
}

}  // namespace kerfbench::source
