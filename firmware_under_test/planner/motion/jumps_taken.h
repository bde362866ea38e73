// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kerfbench::planner {

/// What jumps are to be like.
struct JumpWish {
  double radius_mm{};       ///< Largest radius of their arcs; > 0.
  std::vector<bool> stops;  ///< stops[k]: the beam rests before and after jump k; missing ones are not set.
  /// True: a jump is straight where that is estimated to take less time than arcs.
  bool soonest{false};
};

/// Jumps of a unit for which arcs were wished (S2): how many have them, and which are straight, with a stop
/// at both ends, and why.
struct JumpsTaken {
  enum class Why {
    kWaits,    ///< The beam waits for the sheet before the mark.
    kField,    ///< All arcs, down to the least radius, leave the field.
    kNoCurve,  ///< No arcs join the ends: the least radius would lead round and round.
    kSooner,   ///< On a moving sheet the unit fits only if the beam stops where that is sooner than arcs.
    kNoRoom    ///< On a moving sheet the unit fits with straight jumps alone.
  };
  struct Straight {
    int entity{-1};  ///< Entity of the mark after the jump; -1 unknown.
    int line{};      ///< Line of the G-code of that mark.
    Why why{};
  };
  int smooth{};
  std::vector<Straight> straight;
};

}  // namespace kerfbench::planner
