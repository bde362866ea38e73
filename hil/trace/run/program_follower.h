// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::trace {

/// How the units of a job lie and are cut.
struct UnitOrder {
  int units{1};
  double pitch_mm{};
  bool alternate{};  ///< Odd units are cut in reverse.
};

/// Follows a head along its program: which line of the G-code it is on, by places that come in their order.
/// For people; nothing judges by it.
class ProgramFollower {
 public:
  struct Place {
    int line{};    ///< From 1; 0: on none.
    int unit{-1};  ///< -1: none.
    friend constexpr bool operator==(const Place&, const Place&) = default;
  };

  /// A text that the planner cannot read has no lines.
  ProgramFollower(const std::string& gcode, const UnitOrder& order);
  [[nodiscard]] bool empty() const { return forward_.empty(); }

  /// Where the head is now; `p_S_mm` in S of unit 0. NaN: nobody knows, and it is on none.
  Place follow(const Eigen::Vector2d& p_S_mm);

 private:
  struct Chord {
    Eigen::Vector2d from_mm, to_mm;
    double length_mm{};
    int line{};
    bool jump{};
  };
  /// The nearest chord ahead.
  struct Nearest {
    std::size_t index{};
    double distance_mm{};
  };
  [[nodiscard]] const std::vector<Chord>& pathOf(int unit) const;
  [[nodiscard]] static Nearest nearestAhead(const std::vector<Chord>& path, std::size_t from, double reach_mm,
                                            const Eigen::Vector2d& p_mm);
  [[nodiscard]] Eigen::Vector2d inUnit(int unit, const Eigen::Vector2d& p_S_mm) const;
  [[nodiscard]] bool begins(int unit, const Eigen::Vector2d& p_S_mm) const;

  UnitOrder order_;
  std::vector<Chord> forward_, backward_;
  int unit_{-1};  ///< -1: before the first.
  std::size_t at_{};
};

}  // namespace kerfbench::trace
