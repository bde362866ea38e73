// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// Burns the path of a lit beam into the sheet. Consecutive steps are burnt as one chord of their path, so
/// that one computation of the beam and one burn serve several steps; Sheet::burn states the effect. The
/// number of steps in a chord follows from the beam's speed in the last chord: about kChord_mm of path, and
/// few enough that a beam at rest cannot move far within them (20 steps of 10 us at 150 m/s²: 3 um).
class Burner {
 public:
  static constexpr double kChord_mm = 0.02;
  static constexpr int kMostSteps = 20;

  explicit Burner(const BoardDescription& board) : sheet_(board) {}

  [[nodiscard]] bool chordOpen() const { return open_; }
  /// Begins a chord; none may be open.
  void open(const Footprint& from) {
    from_ = from;
    open_ = true;
  }
  /// Adds a step to the chord, in which the beam delivered this energy. True: the chord is to be closed at
  /// the step's end.
  bool add(double energy_j) {
    energy_j_ += energy_j;
    return ++steps_ >= planned_;
  }
  /// Ends the chord here and burns it.
  void close(const Footprint& to);
  /// Ends the chord where the beam misses the board: its energy went elsewhere.
  void drop();
  /// Burns a part of a step on its own.
  void burn(const Footprint& from, const Footprint& to, double energy_j) { sheet_.burn(from, to, energy_j); }

  /// As Sheet::part(); what is in an open chord stays with the machine.
  Sheet part(double x_S_mm) { return sheet_.part(x_S_mm); }

  /// The sheet without what is in an open chord.
  [[nodiscard]] const Sheet& sheet() const { return sheet_; }

 private:
  Sheet sheet_;
  Footprint from_;
  bool open_{false};
  double energy_j_{0.0};
  int steps_{0};
  int planned_{1};
};

}  // namespace kerfbench::twin
