// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "twin/signal/pulse_decoder.h"

namespace kerfbench::validation {

/// Speed along a piece of path: from `begin` up to `top` and down to `end`, at this acceleration.
struct Speeds {
  double begin_mm_s{};
  double top_mm_s{};
  double end_mm_s{};
  /// Acceleration; infinite: `top` from end to end.
  double acceleration_mm_s2{std::numeric_limits<double>::infinity()};
};

/// A path of lines and arcs over time, the validation's own motion planner: it follows the given pieces and
/// smooths nothing.
class Motion {
 public:
  explicit Motion(const Eigen::Vector2d& start_mm) : pen_mm_(start_mm) {}

  void line(const Eigen::Vector2d& to_mm, const Speeds& speeds, bool lit);
  /// Adds an arc around `centre_mm` by `turn_rad`, positive counter-clockwise.
  void arc(const Eigen::Vector2d& centre_mm, double turn_rad, const Speeds& speeds, bool lit);
  void rest(double time_s);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  /// Place at a time, which is clamped to the motion.
  [[nodiscard]] Eigen::Vector2d at_mm(double time_s) const;
  /// Begin and end of every lit piece; pieces that follow each other are not joined.
  [[nodiscard]] std::vector<std::pair<double, double>> lit_s() const;
  /// Distance of a point from a lit piece, by its index in lit_s().
  [[nodiscard]] double distance_mm(const Eigen::Vector2d& p_mm, std::size_t lit_piece) const;
  /// Distance of a point from the nearest lit piece.
  [[nodiscard]] double distance_mm(const Eigen::Vector2d& p_mm) const;

 private:
  struct Piece {
    double begin_s{}, time_s{}, length_mm{};
    Speeds speeds;
    double up_s{}, flat_s{};
    Eigen::Vector2d from_mm{Eigen::Vector2d::Zero()}, to_mm{Eigen::Vector2d::Zero()};
    Eigen::Vector2d centre_mm{Eigen::Vector2d::Zero()};
    double turn_rad{};  ///< Turn of an arc; 0: a line.
    bool lit{};
  };
  void add(Piece piece);
  [[nodiscard]] static double travel_mm(const Piece& piece, double time_s);
  [[nodiscard]] static Eigen::Vector2d place_mm(const Piece& piece, double travel_mm);
  [[nodiscard]] static double distanceFrom_mm(const Piece& piece, const Eigen::Vector2d& p_mm);

  Eigen::Vector2d pen_mm_;
  double duration_s_{0.0};
  std::vector<Piece> pieces_;
};

/// Formula (2) of S4, written again: mirror angles for a spot on the resting sheet.
struct PaperHead {
  double throw_mm{500.0};
  double spacing_mm{15.0};
  [[nodiscard]] Eigen::Vector2d angles_rad(const Eigen::Vector2d& p_mm) const;
  /// Spot by formula (1).
  [[nodiscard]] Eigen::Vector2d spot_mm(const Eigen::Vector2d& angles_rad) const;
};

/// Pulses lie on this grid, so that an integrator of that step never has to split one.
inline constexpr double kPulseGrid_s = 0.2e-6;

/// Pulses that keep a drive's command within half a step of `target` over [0, end_s]; it starts at 0.
/// @throws std::invalid_argument if the target needs more than one pulse in a slot of the grid.
std::vector<twin::StepEdge> pulsesFor(const std::function<double(double time_s)>& target, double step,
                                      double end_s);

}  // namespace kerfbench::validation
