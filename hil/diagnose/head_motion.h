// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::diagnose {

/// What the pins tell of a machine's motion.
struct MotionSource {
  /// Where the pulses up to a time lead the beam, W, mm; NaN where it has no place.
  std::function<Eigen::Vector2d(double time_s)> place_W_mm;
  std::function<double(double time_s)> sheet_x_mm;  ///< x_W of unit 0's origin, by the belt's encoder.
  /// Spans in which the laser's gate is open; by time, apart from one another.
  std::vector<Eigen::Vector2d> gates_s;
  double end_s{};
};

/// The head at one time.
struct MotionInstant {
  double time_s{};
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
  double sheet_x_mm{};
  bool lit{};
  double path_mm{};  ///< Length of the way in W so far, S0's G(t).
};

/// One opening of the gate.
struct MotionCut {
  double from_s{}, to_s{};
  Eigen::Vector2d from_W_mm{Eigen::Vector2d::Zero()}, to_W_mm{Eigen::Vector2d::Zero()};
  double sheet_mm{};  ///< Travel of the sheet meanwhile.
  [[nodiscard]] double durationS() const { return to_s - from_s; }
  /// Mean velocity in W, mm/s.
  [[nodiscard]] Eigen::Vector2d velocityW() const { return (to_W_mm - from_W_mm) / durationS(); }
  /// Way over the sheet from begin to end, mm.
  [[nodiscard]] Eigen::Vector2d overSheet_mm() const {
    return to_W_mm - from_W_mm - Eigen::Vector2d(sheet_mm, 0.0);
  }
};

/// Where pulses have led a head: the drives follow them a little later, and whether they do is not known
/// here.
struct HeadMotion {
  std::vector<MotionInstant> instants;  ///< From 0 s on, and one at each edge of the gate.
  std::vector<MotionCut> cuts;
};

/// every_s > 0: time between the instants; lengths are those of the chords between them.
HeadMotion headMotion(const MotionSource& source, double every_s);

/// Instants as CSV.
std::string motionTable(const HeadMotion& motion);
/// Cuts as text for people, a line each.
std::string cutTable(const HeadMotion& motion);
/// Way of the beam in W, cuts apart from the rest.
std::string wayPicture(const HeadMotion& motion);
/// The same over the sheet, in S of unit 0.
std::string sheetPicture(const HeadMotion& motion);
/// G(t): length of the way over time.
std::string lengthPicture(const HeadMotion& motion);

}  // namespace kerfbench::diagnose
