// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/loop_back.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/line_levels.h"
#include "hil/source/gpio/line_request.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kIn = 0;
constexpr std::chrono::milliseconds kLook{10};
constexpr std::uint64_t kQuiet_ns = 100'000'000;  // With no edge after the train, all have come.
constexpr std::uint64_t kLoopPatience_ns =
    1'000'000'000;                               // With edges after the train, more than this is noise.
constexpr std::uint64_t kSettle_ns = 1'000'000;  // Opto-couplers take microseconds.

LineRequest listenTo(const std::shared_ptr<GpioSystem>& system, const LoopBackLines& lines) {
  return {system, lines.in_chip, {lines.in, lines.beside}};
}

/// Reads what a train makes.
class LoopReader {
 public:
  LoopReader(std::shared_ptr<GpioSystem> system, LineRequest& request, std::size_t room)
      : system_(std::move(system)),
        request_(request),
        order_(orderFrom(*system_, request_, begin_ns_)),
        cpu_begin_ns_(system_->threadTime_ns()),
        last_ns_(begin_ns_) {
    edges_.reserve(room);
  }

  void listen(const EdgeTrain& train) {
    std::optional<std::uint64_t> over_ns;
    for (;;) {
      const bool over = train.done();
      const bool came = read();
      const std::uint64_t now_ns = system_->now_ns();
      if (!over) continue;
      if (!over_ns) over_ns = now_ns;
      if (!came && now_ns - std::max(last_ns_, *over_ns) >= kQuiet_ns) break;
      if (now_ns - *over_ns >= kLoopPatience_ns) break;
    }
    cpu_ns_ = system_->threadTime_ns() - cpu_begin_ns_;
    order_.takeAll(edges_);
  }

  void report(const DrivenTrain& train, LoopBackStep& step) {
    std::vector<LineEdge> in;
    std::ranges::copy_if(edges_, std::back_inserter(in),
                         [](const LineEdge& edge) { return edge.line == kIn; });
    step.read = in.size();
    step.beside = edges_.size() - in.size();
    step.worst_read_ns = worst_read_ns_;
    if (last_ns_ > begin_ns_)
      step.cpu_share = static_cast<double>(cpu_ns_) / static_cast<double>(last_ns_ - begin_ns_);
    step.problems = edgeTroubles(order_, begin_ns_);
    for (std::string& words : levelsAgainstEdges(request_, order_)) step.problems.push_back(std::move(words));
    if (step.read != step.driven) {
      step.problems.push_back(
          fmt::format("{} edges were driven, and {} were read{}", step.driven, step.read,
                      step.read > step.driven ? ": the line bounces or picks up noise" : ""));
    }
    if (step.held()) judgeStamps(train, in, step);
  }

 private:
  static EdgeOrder orderFrom(GpioSystem& system, LineRequest& request, std::uint64_t& begin_ns) {
    std::vector<bool> levels = request.levels();
    begin_ns = system.now_ns();
    return {std::move(levels), begin_ns};
  }
  bool read() {
    read_.clear();
    request_.read(kLook, read_);
    if (read_.empty()) return false;
    last_ns_ = system_->now_ns();
    for (const KernelEdge& edge : read_)
      worst_read_ns_ = std::max(worst_read_ns_, last_ns_ - std::min(last_ns_, edge.stamp_ns));
    order_.add(read_, last_ns_);
    if (last_ns_ - begin_ns_ > EdgeOrder::kHold_ns)
      order_.take(last_ns_, last_ns_ - EdgeOrder::kHold_ns, edges_);
    return true;
  }

  /// Nothing is stamped before it happens, so a stamp is late or right.
  static void judgeStamps(const DrivenTrain& train, const std::vector<LineEdge>& in, LoopBackStep& step) {
    std::vector<std::uint64_t> least_ns;
    std::vector<std::uint64_t> most_ns;
    std::uint64_t earlier = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const auto& [before_ns, after_ns] = train.edges[i];
      const std::uint64_t stamp_ns = in[i].stamp_ns;
      if (stamp_ns < before_ns) ++earlier;
      least_ns.push_back(stamp_ns - std::min(stamp_ns, after_ns));
      most_ns.push_back(stamp_ns - std::min(stamp_ns, before_ns));
    }
    if (earlier > 0) {
      step.problems.push_back(fmt::format(
          "{} edges were stamped before they were driven: they are not the output's, or the stamps "
          "are of another clock",
          earlier));
      return;
    }
    step.stamp_least = spreadOf(std::move(least_ns));
    step.stamp_most = spreadOf(std::move(most_ns));
  }

  std::shared_ptr<GpioSystem> system_;
  LineRequest& request_;
  std::uint64_t begin_ns_{};
  EdgeOrder order_;
  std::uint64_t cpu_begin_ns_;
  std::uint64_t last_ns_;  ///< Time at which the last edge was read.
  std::uint64_t cpu_ns_{};
  std::uint64_t worst_read_ns_{};
  std::vector<KernelEdge> read_;
  std::vector<LineEdge> edges_;
};

}  // namespace

TimeSpread spreadOf(std::vector<std::uint64_t> times_ns) {
  if (times_ns.empty()) return {};
  std::ranges::sort(times_ns);
  double squares = 0.0;
  for (const std::uint64_t time_ns : times_ns)
    squares += static_cast<double>(time_ns) * static_cast<double>(time_ns);
  const std::size_t rank = (times_ns.size() * 95 + 99) / 100;
  return {times_ns.back(), times_ns[rank - 1], std::sqrt(squares / static_cast<double>(times_ns.size()))};
}

std::string wireTrouble(const std::shared_ptr<GpioSystem>& system, const LoopBackLines& lines,
                        EdgeTrain& train) {
  LineRequest request = listenTo(system, lines);
  std::string seen;
  for (const bool level : {false, true, false, true, false}) {
    train.set(level);
    short none = 0;
    system->poll(-1, kSettle_ns, none);
    seen += request.levels()[kIn] ? '1' : '0';
  }
  if (seen == "01010") return "";
  const std::string which =
      fmt::format("{}: line {} ({})", lines.in_chip.string(), lines.in.offset, lines.in.name);
  const std::string from =
      fmt::format("line {} ({}) of {}", lines.out.offset, lines.out.name, lines.out_chip.string());
  if (seen == "10101")
    return fmt::format("{} is the inverse of {}: wire them without an inverter", which, from);
  if (seen == "00000" || seen == "11111") {
    return fmt::format("{} stays {} whatever {} does: the jumper is missing, or on other lines", which,
                       seen[0] == '1' ? "high" : "low", from);
  }
  return fmt::format(
      "{} does not follow {}: driven 01010, it was {}; the jumper has no contact, or somebody "
      "else drives the line",
      which, from, seen);
}

LoopBackStep measureLoopBack(const std::shared_ptr<GpioSystem>& system, const LoopBackLines& lines,
                             EdgeTrain& train, const TrainPlan& plan) {
  LineRequest request = listenTo(system, lines);  // New request, so that its numbers begin anew.
  LoopReader reader(system, request, plan.edges);
  train.begin(plan);
  reader.listen(train);
  const DrivenTrain driven = train.end();
  LoopBackStep step;
  step.asked_hz = 1e9 / static_cast<double>(plan.period_ns);
  step.driven_hz = driven.rate_hz();
  step.driven = driven.edges.size();
  step.worst_put_ns = driven.lag.worst_ns();
  reader.report(driven, step);
  return step;
}

}  // namespace kerfbench::source
