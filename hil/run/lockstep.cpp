// SPDX-License-Identifier: Apache-2.0
#include "hil/run/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kerfbench::run {
namespace {

// A vector that grows copies what it has, and a clock waits for nobody. Memory that is not used costs
// nothing.
constexpr std::size_t kLiveEdges = std::size_t{1} << 20U;

void sendSensors(source::SignalSource& source, const std::vector<SensorEdge>& edges, const SignalMap& map,
                 source::PinRecording& recording) {
  for (const SensorEdge& edge : edges) {
    const auto pin = map.pin(edge.signal);
    if (!pin) continue;
    source.drive(*pin, edge.level, edge.tick);
    recording.sensors.push_back(edge);
  }
}

std::string describe(source::Stop stop, const source::SignalSource& source, double now_s) {
  const std::string where = fmt::format(" at {:.3f} s: {}", now_s, source.message());
  switch (stop) {
    case source::Stop::kCrashed:
      return "the firmware or its emulator crashed" + where;
    case source::Stop::kFlooded:
      return "the firmware floods its pins" + where;
    case source::Stop::kHung:
      return "the emulator does not answer" + where;
    case source::Stop::kLost:
      return "the real pins were lost" + where;
    case source::Stop::kEnded:
      return "the firmware halted before the job was done" + where;
    case source::Stop::kReached:
      break;
  }
  return {};
}

/// A replay of the recording has to know as well. (It finds gaps by itself.)
void spoil(const std::string& problem, RecordedRun& result) {
  result.problems.push_back(problem);
  result.recording.problems.push_back(problem);
}

bool hasGap(const std::vector<PinEvent>& events) {
  return std::ranges::any_of(events, [](const PinEvent& e) { return (e.flags & PinEvent::kGap) != 0; });
}

/// Where pin events were lost: of a hopeless front end in every quantum, and that is one fault.
class Gaps {
 public:
  void add(double now_s) {
    if (count_++ == 0) first_s_ = now_s;
    last_s_ = now_s;
  }
  /// Goes before what came of it.
  void tell(std::vector<std::string>& problems) const {
    if (count_ == 0) return;
    std::string text = fmt::format("pin events were lost before {:.6f} s", first_s_);
    if (count_ > 1) text += fmt::format(" and {} times more, the last before {:.6f} s", count_ - 1, last_s_);
    problems.insert(problems.begin(), std::move(text));
  }

 private:
  std::size_t count_{};
  double first_s_{};
  double last_s_{};
};

}  // namespace

RecordedRun runLockstep(source::SignalSource& source, LockstepModel& model, const SignalMap& map,
                        Dialog* dialog, const LockstepOptions& options, const ProgressFn& progress) {
  const source::SourceInfo info = source.info();
  const Tick quantum =
      std::max<Tick>(1, info.rate.ticksAt(std::min(options.quantum_s, model.longestQuantum_s())));
  const Tick limit = info.rate.ticksAt(options.time_limit_s);
  RecordedRun result;
  result.recording.rate = info.rate;
  if (!info.deterministic) {
    result.recording.outputs.reserve(kLiveEdges);
    result.recording.sensors.reserve(kLiveEdges);
  }
  Tick now = 0;
  Tick end = limit;
  bool finishing = false;
  bool ended = false;
  source::Batch batch;
  Gaps gaps;
  for (int round = 0; now < end; ++round) {
    const Tick until = std::min(now + quantum, end);
    if (info.accepts_input) {
      std::vector<SensorEdge> edges = model.predictSensors(until);
      if (options.provocation != nullptr) options.provocation->changeSensors(edges, now, until);
      sendSensors(source, edges, map, result.recording);
    }
    const source::Stop stop = source.advance(until, batch);
    now = batch.watermark;
    if (hasGap(batch.events)) gaps.add(info.rate.seconds(now));
    model.advance(now, batch.events);
    result.recording.outputs.insert(result.recording.outputs.end(), batch.events.begin(), batch.events.end());
    ended = stop == source::Stop::kEnded;
    if (ended && dialog == nullptr) break;
    if (stop != source::Stop::kReached) {
      spoil(describe(stop, source, info.rate.seconds(now)), result);
      break;
    }
    const double now_s = info.rate.seconds(now);
    if (!batch.uart.empty()) result.recording.uart.push_back({batch.uart_heard, batch.uart});
    if (dialog != nullptr && !finishing) {
      auto answer = dialog->step(batch.uart, now_s);
      if (options.provocation != nullptr) answer = options.provocation->toController(answer, now_s);
      if (!answer.empty()) source.uartWrite(answer);
      finishing = dialog->state() != Dialog::State::kBusy;
      if (dialog->state() == Dialog::State::kFailed) {
        result.dialog.reason = fmt::format("at {:.3f} s: {}", now_s, dialog->message());
        result.dialog.time_s = info.rate.seconds(batch.uart_heard);
      }
      // A whole number of quanta, so that a replay of the recording steps the twin through the same instants.
      if (finishing)
        end = std::min(limit, now + quantum * (1 + info.rate.ticksAt(options.settle_s) / quantum));
    }
    if (progress && round % 100 == 0) progress(now_s, dialog != nullptr ? dialog->message() : "replaying");
  }
  gaps.tell(result.problems);
  if (dialog != nullptr && !finishing && result.problems.empty() && options.provocation == nullptr) {
    spoil(fmt::format("the time limit of {} s was reached ({})", options.time_limit_s, dialog->message()),
          result);
  }
  if (dialog == nullptr && !ended && result.problems.empty()) {
    spoil(fmt::format("the time limit of {} s was reached before {}", options.time_limit_s,
                      info.accepts_input ? "the pins were quiet" : "the end of the recording"),
          result);
  }
  result.recording.end = now;
  return result;
}

}  // namespace kerfbench::run
