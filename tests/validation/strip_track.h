// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::validation {

/// Commanded motion of an axis: pieces of constant acceleration in a row. Pieces that were pulsed are
/// dropped, so a track of any length takes little memory.
class Track {
 public:
  struct Piece {
    double begin_s{}, end_s{};
    double place_mm{}, speed_mm_s{}, acceleration_mm_s2{};  ///< State at begin; the speed keeps its sign.
    [[nodiscard]] int direction() const;
    /// Distance from the piece's begin to a time in it, unsigned.
    [[nodiscard]] double distance_mm(double time_s) const;
    /// Time at which the piece has made this distance; the distance must lie in it.
    [[nodiscard]] double timeOf_s(double distance_mm) const;
  };

  explicit Track(double place_mm) : place_mm_(place_mm) {}

  /// Goes on at the present speed.
  void keepUntil(double time_s);
  void speedUpTo(double speed_mm_s, double acceleration_mm_s2);
  /// Moves from the present speed to rest at a place, no faster than this.
  void moveTo(double place_mm, double top_mm_s, double acceleration_mm_s2);

  /// Time of the last piece's end.
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] double place_mm() const { return place_mm_; }

  [[nodiscard]] const Piece* front() const { return pieces_.empty() ? nullptr : &pieces_.front(); }
  void dropFront() { pieces_.pop_front(); }

 private:
  void add(double duration_s, double acceleration_mm_s2);

  double time_s_{0.0};
  double place_mm_;
  double speed_mm_s_{0.0};
  std::deque<Piece> pieces_;
};

struct PinWrite {
  Tick tick{};
  Signal signal{};
  bool level{};
};

/// PUL and DIR that follow a track to within half a step. The first pulse comes later than DIR by far more
/// than any drive requires, since every motion begins at rest.
class PulseTrain {
 public:
  PulseTrain(Signal pul, Signal dir, double step_mm, double place_mm)
      : pul_(pul), dir_(dir), step_mm_(step_mm), track_(place_mm) {}

  [[nodiscard]] Track& track() { return track_; }
  /// Appends the pins' writes before `until_s`; the falling edge of the last pulse may lie after it.
  void appendUntil(double until_s, TickRate rate, std::vector<PinWrite>& writes);

 private:
  Signal pul_, dir_;
  double step_mm_;
  Track track_;
  long long count_{0};  ///< Number of steps from the axis's zero.
  bool dir_level_{false};
  double last_edge_s_{-1.0};
};

}  // namespace kerfbench::validation
