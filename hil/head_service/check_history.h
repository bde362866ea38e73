// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/calibrate/head/quick_check.h"

namespace kerfbench::head_service {

/// Drifts that are followed from check to check: QuickCheckResult::of_head.
inline constexpr std::size_t kFollowedDrifts = calibrate::kHeadDriftCount - 1;

/// A quick check as it is kept: one line of JSON in checks.jsonl.
struct HeadCheckRecord {
  struct Value {
    double value{};
    double U{};  ///< k = 2.
  };
  std::string date;  ///< ISO 8601 day.
  std::string machine;
  std::string calibration;  ///< Digest of the calibration that it was held against.
  std::string sheet;        ///< Digest of what was measured.
  bool holds{};
  double off_mm{};                              ///< Largest error of a mark.
  std::array<Value, kFollowedDrifts> drifts{};  ///< In the order and units of QuickCheckResult::of_head.
};

HeadCheckRecord recordOf(const calibrate::QuickCheckResult& result);
/// All checks of a file, by date; none where there is no file. @throws ConfigError with each bad line.
std::vector<HeadCheckRecord> readCheckHistory(const std::filesystem::path& path);
/// Adds a check to the file; the same sheet of the same day, held against the same calibration, takes its
/// former place. Returns all. @throws ConfigError as readCheckHistory().
std::vector<HeadCheckRecord> addToCheckHistory(const std::filesystem::path& path,
                                               const HeadCheckRecord& record);

/// What a drift of 1 moves the beam by, at most, in a field about W's origin: mm for each unit of the drift.
std::array<double, kFollowedDrifts> effectsAtRim(const Eigen::AlignedBox2d& field_W_mm);

/// Straight line through the values of one drift over days.
struct DriftTrend {
  std::size_t checks{};
  double per_month{}, U_per_month{};  ///< Month of 365.25 / 12 days; k = 2.
  /// Days since 1970-01-01 on which its effect reaches the limit: the first on which it may (value and U),
  /// and the one on which the line does; nullopt within ten years.
  std::optional<int> may_day, likely_day;
  double first_value{};  ///< The line on the day of the first check,
  int first_day{};
  [[nodiscard]] bool drifts() const;
};

/// Lines weighted by U; where the values scatter more than their U lets expect, U of the line is raised by
/// that. Needs three checks on two days, or more: else nullopt. `records` are of one calibration, by date.
/// @param effect_mm of effectsAtRim(). @param limit_mm > 0.
std::optional<DriftTrend> trendOf(const std::vector<HeadCheckRecord>& records, std::size_t drift,
                                  double effect_mm, double limit_mm);

}  // namespace kerfbench::head_service
