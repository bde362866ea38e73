// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "firmware_under_test/planner/motion/pieces.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// The speeds that a stretch of path admits under a limit of jerk: as SpeedProfile, with nodes at the borders
/// of pieces (see Pieces for the shares of the limits), where the path rests in acceleration.
///
/// Within a piece the speed changes along at most two S-curves, by way of a level speed. A motion is all
/// nodes and all levels cut off at one speed, between the slowest and the fastest that the ends admit. Room
/// for the S-curves is reserved by Ramp::mostWayMm(), so whatever is cut off between two admissible profiles
/// is admissible too.
class JerkProfile {
 public:
  /// A stretch with the laser in one state: all marks of one Z, or one jump.
  JerkProfile(std::span<const Segment> run, const FlowLimits& limits);

  [[nodiscard]] double firstCap() const { return path_.cap_mm_s.front(); }  ///< At the start, mm/s.
  [[nodiscard]] double lastCap() const { return path_.cap_mm_s.back(); }

  /// Speeds at the nodes.
  using Speeds = std::vector<double>;
  /// Fastest after starting with v_mm_s, and slowest (braking at once).
  [[nodiscard]] Speeds fastestFrom(double v_mm_s) const;
  [[nodiscard]] Speeds slowestFrom(double v_mm_s) const;
  /// Fastest that still ends with v_mm_s, and slowest (speeding up at last).
  [[nodiscard]] Speeds fastestTo(double v_mm_s) const;
  [[nodiscard]] Speeds slowestTo(double v_mm_s) const;

  /// Duration of the fastest motion between the given nodes.
  [[nodiscard]] double shortestS(const Speeds& fast) const;
  /// Whether the slowest motion between the nodes told takes so long. It may take any time if it can rest.
  [[nodiscard]] bool canTake(const Speeds& slow, double total_s) const;
  /// Arc lengths at the end of each of `periods` equal times, of a motion between slow and fast that takes
  /// them.
  [[nodiscard]] std::vector<double> stations(const Speeds& slow, const Speeds& fast, int periods,
                                             double period_s) const;

 private:
  /// A piece in motion: v0, a ramp, a level stretch, a ramp, v1; or the ramp between two level stretches.
  struct Course {
    double at_v0_mm{};
    double middle_mm_s{};
    double at_middle_mm{};
  };
  [[nodiscard]] static Course courseOf(const Piece& piece, double v0_mm_s, double v1_mm_s, double cut_mm_s);
  [[nodiscard]] double durationS(const Speeds& speeds, double cut_mm_s) const;
  [[nodiscard]] static Speeds cutOff(const Speeds& slow, const Speeds& fast, double cut_mm_s);

  Pieces path_;
};

/// What FlowLimits are to pieces of marks, or of a jump.
SpeedLimits speedLimitsOf(const FlowLimits& limits, bool jump);

}  // namespace kerfbench::planner
