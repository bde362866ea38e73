// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/unit.h"
#include "firmware_under_test/planner/program/payload.h"

namespace kerfbench::planner {

/// Writes the operations of a program, period by period. The steps of the head's axes are chosen at the end:
/// those of a stepper are chosen for many periods at once (head/stepper.h).
class Writer {
 public:
  Writer(const Axes& axes, const MachineParameters& machine, const JobParameters& job,
         double belt_speed_mm_s);

  /// Writes one period that ends with the beam at p_W; `mark` is on the sheet, if the laser is on.
  void period(const Eigen::Vector2d& p_W_mm, const Sample* mark, int entity);
  void hold(int periods);
  void reposition(const Eigen::Vector2d& to_W_mm, double v0_mm_s);
  /// Waits for the print mark, and for encoder counts behind it.
  void waitMark(std::int32_t offset);
  void follow(bool on);

  void startFeed() { feed_target_ = v_; }
  void stopFeed() { feed_target_ = 0.0; }
  /// Feeds one pitch from rest to rest during the next periods.
  void feedPitch() { pitch_period_ = 0; }
  [[nodiscard]] bool feedsPitch() const { return pitch_period_.has_value(); }
  [[nodiscard]] bool feedAtTarget() const { return feed_speed_ == feed_target_; }
  [[nodiscard]] double feedMm() const { return feed_mm_; }
  [[nodiscard]] const Eigen::Vector2d& at() const { return p_W_mm_; }

  /// How many operations there are so far.
  [[nodiscard]] std::size_t operations() const { return entries_.size(); }

  /// All operations, the end of the program included. @throws PlanError if an axis would have to make more
  /// steps in a period than the controller can, or to turn round faster than its drive can.
  std::vector<Payload> finish();

 private:
  /// An operation that takes a period, or one that takes none or waits.
  struct Entry {
    std::optional<Eigen::Vector2d> wanted;  ///< Commanded place of both axes at the end of the period, steps.
    int entity{-1};
    int feed_steps{};
    std::optional<std::uint8_t> power;
    std::optional<std::uint16_t> gain;
    Payload op;  ///< The operation, where it takes no period.
    bool waits{};
  };

  std::uint8_t powerOf(const Sample& mark);
  int feedSteps();
  int feedTo(double belt_mm);
  std::vector<std::array<int, 2>> positions() const;
  void choose(std::size_t begin, std::size_t end, int axis, std::vector<std::array<int, 2>>& to) const;
  void checkCount(const Entry& entry, const std::array<int, 2>& count);
  void checkTurn(int axis, int count, int entity);
  Payload move(const Entry& entry, const std::array<int, 2>& count) const;

  const Axes& axes_;
  const MachineParameters& machine_;
  const JobParameters& job_;
  double v_;
  double period_s_;
  std::vector<Entry> entries_;
  Eigen::Vector2d p_W_mm_;
  std::array<int, 2> count_before_{};
  bool following_{false};
  double gain_{};
  double feed_speed_{}, feed_target_{}, feed_mm_{};
  std::optional<int> pitch_period_;  ///< Period of the feed by one pitch that is under way.
  int pitches_{};
  double owed_w_{};  ///< Power of one period that rounding has left.
  long feed_steps_{};
};

}  // namespace kerfbench::planner
