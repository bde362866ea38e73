// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "tests/validation/strip_track.h"
#include "twin/description/description.h"

namespace kerfbench::validation {

/// Hu, Hu, Jiang 2014 (S0): a strip is cut across into pieces of one length.
struct StripJob {
  enum class Regime { kStopAndGo, kContinuous };
  Regime regime{Regime::kContinuous};
  double width_mm{800.0};     ///< Width y0.
  double length_mm{1200.0};   ///< Length L of a piece.
  double feed_mm_s{200.0};    ///< Feed v_x.
  double cut_mm_s{230.0};     ///< Cutting speed v_y.
  double return_mm_s{400.0};  ///< Return speed v_0.
  double gantry_acceleration_mm_s2{2500.0};
  double feed_acceleration_mm_s2{500.0};  ///< Acceleration of the belt, in stop-and-go.
  /// Distance across before and behind the strip at full speed, in which the servos settle; the laser is lit
  /// in the half next to the strip.
  double run_up_mm{2.0};

  /// The paper's times without any ramp: 9.478 n s and 3.478 + 6 n s for its example.
  [[nodiscard]] double formula_s(int pieces) const;
  /// Time that ramps and run-ups add to it for the n-th piece, if the head is back in time.
  [[nodiscard]] double ramps_s(int pieces) const;
  /// Time from the start of a continuous cut to the start of the next if the head never waits: the paper's
  /// (y0/v_y)(1 + v_x/v_0), and with all ramps.
  [[nodiscard]] double idealCycle_s() const { return width_mm / cut_mm_s * (1.0 + feed_mm_s / return_mm_s); }
  [[nodiscard]] double cycle_s() const;
  /// Smallest v_0 of (v_x/v_y)(v_x/v_0 + 1) y0 <= L.
  [[nodiscard]] double returnLimit_mm_s() const;
};

/// A controller of its own, independent of the reference controller: PUL, DIR, feed and laser pins of the two
/// regimes, from the clock alone. The beam runs up outside the strip, crosses it at constant speed relative
/// to it, and cuts back the next time. Where the head is back too late, it cuts too late.
///
/// The line of cut n (1, 2, …) passes x_W = 0 at time n L / v_x (continuous) or comes to rest there
/// (stop-and-go).
class StripController {
 public:
  /// Sense along y of the n-th cut.
  static double sense(int cut) { return cut % 2 == 1 ? 1.0 : -1.0; }

  StripController(const StripJob& job, const twin::MachineDescription& machine, TickRate rate);

  /// Appends all pin events in (last `until`, until].
  void advance(Tick until, std::vector<PinEvent>& events);

 private:
  struct GateChange {
    double time_s{};
    bool open{};
  };

  void planCut();
  void planFeed();
  void planCrossing(double edge_s);

  StripJob job_;
  SignalMap map_;
  TickRate rate_;
  PulseTrain x_, y_, feed_;
  std::deque<GateChange> gate_;
  int cut_{0};
  double free_s_{0.0};  ///< Time from which the head is back and at rest, or the belt may go.
  std::vector<PinWrite> writes_;
  std::vector<std::uint16_t> ports_;
  bool started_{false};
};

}  // namespace kerfbench::validation
