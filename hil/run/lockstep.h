// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/base/progress.h"
#include "hil/controller/controller_report.h"
#include "hil/run/dialog.h"
#include "hil/run/onlooker.h"
#include "hil/run/provoke.h"
#include "hil/scenario/case.h"
#include "hil/source/signal_source.h"
#include "hil/source/vcd.h"

namespace kerfbench::run {

/// Hears the controller's events up to `until`, by tick.
using Hearing = std::function<void(Tick until, std::span<const PinEvent> events)>;

/// A job that is in the controller and is not spoken of.
struct SelfStart {
  double quiet_s{};               ///< Time without a pulse of the head after which it is over; > 0.
  std::optional<double> press_s;  ///< Time at which the start button is pressed; empty: never.
  std::vector<Signal> falling;    ///< PULs that step on their falling edge.
  static constexpr double kPressed_s = 0.1;  ///< Time for which it is held.
};

struct LockstepOptions {
  /// The twin predicts its sensor edges this far ahead; at a belt acceleration of 2 m/s² that misplaces an
  /// edge by 0.25 um at most.
  double quantum_s{0.5e-3};
  double time_limit_s{60.0};
  std::optional<SelfStart> by_itself{};  ///< Only without a dialog, and not for a recording.
  Provocation* provocation{};            ///< May be null. If not, a dialog that never ends is no problem.
  Hearing heard{};                       ///< Is told of each quantum before the model makes it; may be empty.
  /// Is told of each quantum after all is done; may be empty.
  std::function<void(const Quantum&)> seen{};
  double settle_s{0.1};  ///< Goes on after the dialog is done: mirrors swing out, the last frame is taken.
};

/// What a run leaves behind, whatever it ran on.
struct RecordedRun {
  source::PinRecording recording;
  controller::DialogFailure dialog;         ///< Left to the caller to judge.
  std::vector<std::string> problems;        ///< Why the evidence cannot be trusted; empty when all went well.
  std::vector<std::string> guard_problems;  ///< Why that of the guard cannot.
};

/// What a run needs of a machine.
class LockstepModel {
 public:
  virtual ~LockstepModel() = default;
  /// Edges of the controller's inputs that it is to be told before (now, until] is run: of a machine that is
  /// emulated those in there, by tick.
  virtual std::vector<SensorEdge> predictSensors(Tick until) = 0;
  /// `events` are all pin events of the controller in (now, until], by tick.
  virtual void advance(Tick until, std::span<const PinEvent> events) = 0;
  /// A run's quanta are no longer than this.
  [[nodiscard]] virtual double longestQuantum_s() const = 0;
};

using base::ProgressFn;

/// Options for a release that a scenario runs in an emulator.
LockstepOptions lockstepFor(const scenario::Case& test_case);

/// Runs source and model quantum by quantum. Where no input depends on the controller (nothing is spoken and
/// no sensor wired), the source may be ahead of the model, with the same result. Else the model's sensor
/// edges of a quantum go to the source before it runs it, the source's pin events go to the model after.
/// `dialog` may be null (a recording, or a job that is started at the machine).
RecordedRun runLockstep(source::SignalSource& source, LockstepModel& model, const SignalMap& map,
                        Dialog* dialog, const LockstepOptions& options, const ProgressFn& progress);

}  // namespace kerfbench::run
