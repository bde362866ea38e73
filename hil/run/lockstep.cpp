// SPDX-License-Identifier: Apache-2.0
#include "hil/run/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "hil/base/one_processor.h"
#include "hil/scenario/pul_axes.h"

namespace kerfbench::run {
namespace {

// A vector that grows copies what it has or waits for the disk, and a clock waits for nobody. Memory that is
// not used costs nothing.
constexpr std::size_t kLiveEdges = std::size_t{1} << 20U;

constexpr std::array kHeadPuls{Signal::kGalvoXPul, Signal::kGalvoYPul, Signal::kGantryXPul,
                               Signal::kGantryYPul};

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
      return "the firmware floods its pins or its UART" + where;
    case source::Stop::kMisheard:
      return "bench and firmware do not hear each other" + where;
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

/// Inputs whose edges depend on what the controller does. The guard is closed before the run begins, and the
/// start button is pressed at its time.
constexpr std::array kFeedback{Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark,
                               Signal::kLimitX,   Signal::kLimitY,   Signal::kPowerMonitor};

bool hasFeedback(const SignalMap& map) {
  return std::ranges::any_of(kFeedback, [&](Signal signal) { return map.pin(signal).has_value(); });
}

/// Whether an axis of the head is told to move.
bool isPulsed(const std::vector<PinEvent>& events, const SignalMap& map) {
  return std::ranges::any_of(kHeadPuls, [&](Signal signal) {
    const std::optional<PinId> pin = map.pin(signal);
    return pin && std::ranges::any_of(events, [&](const PinEvent& event) {
             return event.port == pin->port && (event.changed >> pin->bit & 1U) != 0;
           });
  });
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

/// A source and a model that advance by turns, quantum by quantum.
class Lockstep {
 public:
  Lockstep(source::SignalSource& source, LockstepModel& model, const SignalMap& map, Dialog* dialog,
           const LockstepOptions& options)
      : source_(source),
        model_(model),
        map_(map),
        dialog_(dialog),
        options_(options),
        info_(source.info()),
        quantum_(
            std::max<Tick>(1, info_.rate.ticksAt(std::min(options.quantum_s, model.longestQuantum_s())))),
        limit_(info_.rate.ticksAt(options.time_limit_s)),
        end_(limit_),
        is_foreseen_(info_.deterministic && info_.accepts_input && options.by_itself && dialog == nullptr &&
                     options.provocation == nullptr && !hasFeedback(map)) {
    result_.recording.rate = info_.rate;
    if (info_.deterministic) return;
    result_.recording.outputs.holdInMemory(kLiveEdges);
    result_.recording.sensors.holdInMemory(kLiveEdges);
  }

  RecordedRun run(const ProgressFn& progress) {
    // A controller that runs ahead need not wait for the machine, nor the machine for it.
    base::OneProcessor together(info_.process);
    for (int round = 0; now_ < end_; ++round) {
      together.turn();
      const Tick from = now_;
      const bool goes_on = advance();
      if (goes_on) talk();
      if (options_.seen) tellOf(from);
      if (!goes_on) break;
      if (progress && round % 100 == 0)
        progress(info_.rate.seconds(now_), dialog_ != nullptr   ? dialog_->message()
                                           : options_.by_itself ? "the controller's own job"
                                                                : "replaying");
    }
    gaps_.tell(result_.problems);
    addTimeLimit();
    result_.recording.end = now_;
    return std::move(result_);
  }

 private:
  /// Sensors first, then the controller's events of the same quantum. False: the source has stopped.
  bool advance() {
    const Tick until = std::min(now_ + quantum_, end_);
    std::vector<SensorEdge>& edges = edges_;
    edges.clear();
    if (info_.accepts_input) {
      edges = model_.predictSensors(until);
      if (options_.provocation != nullptr) options_.provocation->changeSensors(edges, now_, until);
      if (options_.by_itself) pressStart(edges, until);
      if (now_ == 0 && info_.deterministic) driveLow();
      sendSensors(source_, edges, map_, result_.recording);
    }
    if (is_foreseen_ && now_ > 0) source_.foresee(quantum_, lastBeforePress(until));
    const source::Stop stop = halted_ ? rest(until) : source_.advance(until, batch_);
    now_ = batch_.watermark;
    if (hasGap(batch_.events)) gaps_.add(info_.rate.seconds(now_));
    if (options_.heard) options_.heard(now_, batch_.events);
    model_.advance(now_, batch_.events);
    result_.recording.outputs.append(batch_.events);
    ended_ = stop == source::Stop::kEnded;
    // A job of its own may end in a halt, and the machine still swings out.
    halted_ = ended_ && options_.by_itself && isStarted();
    if (halted_) return true;
    if (ended_ && dialog_ == nullptr && !options_.by_itself) return false;
    if (stop == source::Stop::kReached) return true;
    spoil(describe(stop, source_, info_.rate.seconds(now_)), result_);
    return false;
  }

  void tellOf(Tick from) {
    options_.seen({from, now_, batch_.events, edges_, batch_.uart, said_});
    said_.clear();
  }

  /// Keeps what the controller said, and answers it.
  void talk() {
    const double now_s = info_.rate.seconds(now_);
    if (!batch_.uart.empty()) result_.recording.uart.push_back({batch_.uart_received, batch_.uart});
    if (dialog_ == nullptr) {
      if (options_.by_itself) watchJob();
      return;
    }
    if (finishing_) return waitForQuiet();
    auto answer = dialog_->step(batch_.uart, now_s);
    if (options_.provocation != nullptr) answer = options_.provocation->toController(answer, now_s);
    if (!answer.empty()) source_.uartWrite(answer);
    if (options_.seen) said_ = answer;
    finishing_ = dialog_->state() != Dialog::State::kBusy;
    if (dialog_->state() == Dialog::State::kFailed) {
      result_.dialog.reason = fmt::format("at {:.3f} s: {}", now_s, dialog_->message());
      result_.dialog.time_s = info_.rate.seconds(batch_.uart_received);
    }
    if (!finishing_) return;
    const bool has_failed = dialog_->state() == Dialog::State::kFailed;
    endIn(std::max(options_.settle_s, has_failed ? 0.0 : dialog_->quiet_s()));
  }

  /// A sensor drives its line from the start, low or high: an emulated input that nobody drives would follow
  /// its pull-up. Recordings say the same by their first level, which is low.
  void driveLow() {
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      if (const auto pin = map_.pin(signal); pin && isSensor(signal)) source_.drive(*pin, false, 1);
    }
  }

  [[nodiscard]] bool isStarted() const { return finishing_ || isStepped(); }

  /// Whether an axis of the head has an active edge, and the job can have begun.
  [[nodiscard]] bool isStepped() const {
    const SelfStart& job = *options_.by_itself;
    if (job.press_s && now_ < info_.rate.ticksAt(*job.press_s)) return false;
    return std::ranges::any_of(kHeadPuls, [&](Signal signal) {
      const std::optional<PinId> pin = map_.pin(signal);
      const bool rising = std::ranges::find(job.falling, signal) == job.falling.end();
      return pin && std::ranges::any_of(batch_.events, [&](const PinEvent& event) {
               return event.port == pin->port && (event.changed >> pin->bit & 1U) != 0 &&
                      ((event.level >> pin->bit & 1U) != 0) == rising && event.tick > 1;
             });
    });
  }

  /// In place of a controller that has halted.
  source::Stop rest(Tick until) {
    batch_ = {};
    batch_.watermark = until;
    return source::Stop::kEnded;
  }

  /// The last border of quanta up to which nothing is driven, at least `until`.
  [[nodiscard]] Tick lastBeforePress(Tick until) const {
    Tick last = end_;
    if (!options_.by_itself->press_s) return last;
    for (const double time_s : pressTimes_s()) {
      const Tick tick = info_.rate.ticksAt(time_s);
      if (tick > until) last = std::min(last, until + (tick - until - 1) / quantum_ * quantum_);
    }
    return last;
  }

  [[nodiscard]] std::array<double, 2> pressTimes_s() const {
    const double press_s = *options_.by_itself->press_s;
    return {press_s, press_s + SelfStart::kPressed_s};
  }

  void pressStart(std::vector<SensorEdge>& edges, Tick until) const {
    if (!options_.by_itself->press_s) return;
    const auto [press_s, release_s] = pressTimes_s();
    for (const auto& [time_s, level] : {std::pair{press_s, true}, {release_s, false}}) {
      const Tick tick = info_.rate.ticksAt(time_s);
      if (tick <= now_ || tick > until) continue;
      edges.insert(std::ranges::upper_bound(edges, tick, {}, &SensorEdge::tick),
                   {tick, Signal::kStart, level});
    }
  }

  /// A job that nobody has sent begins with its first pulse, and is over when the head has been quiet. What
  /// the firmware does before its button is pressed is none of it.
  void watchJob() {
    if (!isStepped()) return;
    finishing_ = true;
    endIn(options_.by_itself->quiet_s);
    pulsed_at_limit_ = end_ == limit_;
  }

  /// A whole number of quanta, so that a replay of the recording steps the twin through the same instants.
  void endIn(double time_s) {
    end_ = std::min(limit_, now_ + quantum_ * (1 + info_.rate.ticksAt(time_s) / quantum_));
  }

  /// The dialog is over, and the head may not be.
  void waitForQuiet() {
    if (!(dialog_->quiet_s() > 0.0) || dialog_->state() == Dialog::State::kFailed) return;
    if (!isPulsed(batch_.events, map_)) return;
    endIn(dialog_->quiet_s());
    pulsed_at_limit_ = end_ == limit_;
  }

  void addTimeLimit() {
    if (dialog_ != nullptr && !finishing_ && result_.problems.empty() && options_.provocation == nullptr) {
      spoil(fmt::format("the time limit of {} s was reached ({})", options_.time_limit_s, dialog_->message()),
            result_);
    }
    if (pulsed_at_limit_ && result_.problems.empty() && options_.provocation == nullptr) {
      spoil(fmt::format("the time limit of {} s was reached before the head was at rest",
                        options_.time_limit_s),
            result_);
    }
    if (dialog_ == nullptr && !ended_ && !finishing_ && result_.problems.empty()) {
      spoil(options_.by_itself
                ? fmt::format("the time limit of {} s was reached, and the head was never pulsed",
                              options_.time_limit_s)
                : fmt::format("the time limit of {} s was reached before {}", options_.time_limit_s,
                              info_.accepts_input ? "the pins were quiet" : "the end of the recording"),
            result_);
    }
  }

  source::SignalSource& source_;
  LockstepModel& model_;
  const SignalMap& map_;
  Dialog* dialog_;
  const LockstepOptions& options_;
  source::SourceInfo info_;
  Tick quantum_;
  Tick limit_;
  Tick end_;
  bool is_foreseen_;  ///< No input depends on what the controller does: it may run ahead.
  Tick now_{0};
  bool finishing_{false};
  bool ended_{false};
  bool halted_{false};
  bool pulsed_at_limit_{false};
  source::Batch batch_;
  std::vector<SensorEdge> edges_;   ///< Sensor edges of the quantum, as the source was told.
  std::vector<std::uint8_t> said_;  ///< The dialog's answer in it.
  Gaps gaps_;
  RecordedRun result_;
};

}  // namespace

LockstepOptions lockstepFor(const scenario::Case& test_case) {
  const scenario::Scenario& scenario = test_case.scenario;
  LockstepOptions options;
  options.time_limit_s = scenario.time_limit_s;
  if (scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kNone) {
    options.by_itself = SelfStart{scenario.firmware.quiet_s, scenario.firmware.start_s, {}};
    for (const auto& [pul, axis] : scenario::pulAxes(test_case.machine))
      if (!axis->profile.active_edge_rising) options.by_itself->falling.push_back(pul);
  }
  return options;
}

RecordedRun runLockstep(source::SignalSource& source, LockstepModel& model, const SignalMap& map,
                        Dialog* dialog, const LockstepOptions& options, const ProgressFn& progress) {
  return Lockstep(source, model, map, dialog, options).run(progress);
}

}  // namespace kerfbench::run
