// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/base/pulse_timing.h"

namespace kerfbench::twin {

/// Step that a drive takes.
struct StepEdge {
  double time_s{};
  int direction{};  ///< +1 or -1, along the axis (DriverProfile::senseOf).
};

/// One PUL/DIR input as the drive behind it sees it. Whether the pulses keep to its data sheet is measured
/// elsewhere (hil/evidence): here they only become steps.
///
/// The drive latches DIR with the active edge of PUL. A DIR that changed less than the set-up time before the
/// edge has not reached the latch: the drive steps in the old direction. A DIR that changes within the hold
/// time after the edge comes too late to matter: the step is latched. The drive's input filter passes a pulse
/// once it has lasted width_s, so a step takes effect width_s after its active edge, and a shorter pulse
/// never does; the same holds for the pause between two pulses (space_s). While the drive is disabled, and
/// for enable_setup_s after, an active edge is lost, as is a step that is not yet certain when it is
/// disabled. Time is in s and must not run backwards.
class PulseDecoder {
 public:
  /// `has_enable`: the drive has an enable line, which is low at first. Without one it is always enabled.
  explicit PulseDecoder(DriverProfile profile, bool has_enable = false);

  /// Sets both levels from this time on; appends the steps that are certain by now.
  void levels(double time_s, bool pul, bool dir, std::vector<StepEdge>& steps);
  /// Sets the level of the enable line from this time on; before levels() of the same time.
  void enableLevel(double time_s, bool level, std::vector<StepEdge>& steps);
  /// States that nothing changes until this time; a pulse that has lasted long enough becomes a step.
  void settle(double time_s, std::vector<StepEdge>& steps);

 private:
  void activeEdge(double time_s);
  void idleEdge(double time_s);

  DriverProfile profile_;
  bool active_;  ///< PUL is at its active level.
  bool dir_{false};
  bool old_dir_{false};  ///< Last level of DIR before this that stood for the set-up time.
  bool enabled_;
  bool pending_{false};  ///< True if a pulse has begun and is not yet long enough to be a step.
  int pending_direction_{};
  double enable_s_{-1e9};  ///< Time at which it was enabled last.
  double edge_s_{-1e9};    ///< Time of the last active edge.
  double idle_s_{-1e9};    ///< Time of the last idle edge.
  double dir_s_{-1e9};     ///< Time of the last change of DIR.
};

}  // namespace kerfbench::twin
