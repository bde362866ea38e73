// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "firmware_under_test/planner/motion/pieces.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// Speeds that a stretch of path admits under a limit of jerk: as SpeedProfile, with nodes at the borders of
/// pieces (see Pieces for the shares of the limits), where the acceleration along the path is zero.
///
/// Within a piece the speed changes along at most two S-curves, with a constant speed between. A motion
/// consists of all nodes and all levels cut off at one speed, between the slowest and the fastest that the
/// ends admit. Room for the S-curves is reserved by Ramp::mostTravelMm(), so any cut between two admissible
/// profiles is admissible too.
class JerkProfile {
 public:
  /// Makes the profile of a stretch with the laser in one state: all marks of one Z, or one jump.
  JerkProfile(std::span<const Segment> run, const FlowLimits& limits);

  /// Highest speed at the start, mm/s.
  [[nodiscard]] double firstCap() const { return path_.cap_mm_s.front(); }
  [[nodiscard]] double lastCap() const { return path_.cap_mm_s.back(); }

  /// Speeds at the nodes.
  using Speeds = std::vector<double>;
  /// Fastest speeds after a start with v_mm_s, and slowest (braking at once).
  [[nodiscard]] Speeds fastestFrom(double v_mm_s) const;
  [[nodiscard]] Speeds slowestFrom(double v_mm_s) const;
  /// Fastest speeds that still end with v_mm_s, and slowest (speeding up at last).
  [[nodiscard]] Speeds fastestTo(double v_mm_s) const;
  [[nodiscard]] Speeds slowestTo(double v_mm_s) const;

  /// Duration of the fastest motion between the given nodes.
  [[nodiscard]] double shortestS(const Speeds& fast) const;
  /// Whether the slowest motion between the given nodes takes at least total_s. It may take any time if it
  /// can rest.
  [[nodiscard]] bool canTake(const Speeds& slow, double total_s) const;
  /// Arc lengths at the end of each of `periods` equal times, of a motion between slow and fast that takes
  /// that long.
  [[nodiscard]] std::vector<double> stations(const Speeds& slow, const Speeds& fast, int periods,
                                             double period_s) const;

 private:
  /// Motion within a piece: v0, a ramp, a constant speed, a ramp, v1; or the ramp between two constant
  /// speeds.
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

/// Limits for pieces of marks, or of a jump, from FlowLimits.
SpeedLimits speedLimitsOf(const FlowLimits& limits, bool jump);

}  // namespace kerfbench::planner
