// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/trace/json_text.h"

namespace kerfbench::trace {

/// The lit path on the sheet, simplified as it comes: a message for each second in which something was burnt.
class BurntPath {
 public:
  static constexpr double kTolerance_mm = 0.02;

  struct Message {
    double from_s{};
    std::string json;
  };
  /// A place of the spot in S of unit 0 at the end of a quantum, by time; `lit` since the place before.
  /// Returns the message that is complete with it, if there is one.
  std::optional<Message> add(double time_s, const Eigen::Vector2d& p_S_mm, bool lit);
  /// Returns the last message, if anything is left for it.
  std::optional<Message> end();

 private:
  struct Point {
    double time_s{};
    Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  };
  void keep(const Point& point, bool begins);
  void finishPath();
  std::optional<Message> take();
  [[nodiscard]] bool isStraightTo(const Point& point) const;

  Point before_{};
  std::vector<Point> open_;  ///< The last point that was kept, and those that may be left out.
  std::optional<double> second_;
  JsonColumn time_, x_, y_, start_;
};

}  // namespace kerfbench::trace
