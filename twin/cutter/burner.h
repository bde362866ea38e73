// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// Burns the way of a lit beam into the sheet. Steps that follow each other are handed over as the chord of
/// their way, so that one look at the beam and one burn do for several; Sheet::burn says what that changes.
/// How many steps make a chord follows from the beam's speed in the last one: about kChord_mm of way, and
/// so few that a beam at rest cannot run far in them (20 steps of 10 us at 150 m/s²: 3 um).
class Burner {
 public:
  static constexpr double kChord_mm = 0.02;
  static constexpr int kMostSteps = 20;

  explicit Burner(const BoardDescription& board) : sheet_(board) {}

  [[nodiscard]] bool chordOpen() const { return open_; }
  /// A chord begins here; none may be open.
  void open(const Footprint& from) {
    from_ = from;
    open_ = true;
  }
  /// A further step of the chord, while the beam delivered this. True: it is to be closed at its end.
  bool add(double energy_j) {
    energy_j_ += energy_j;
    return ++steps_ >= planned_;
  }
  /// The chord ends here.
  void close(const Footprint& to);
  /// The chord ends where the beam misses the board: what it delivered went elsewhere.
  void drop();
  /// A part of a step by itself.
  void burn(const Footprint& from, const Footprint& to, double energy_j) { sheet_.burn(from, to, energy_j); }

  /// Without what is in an open chord.
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
