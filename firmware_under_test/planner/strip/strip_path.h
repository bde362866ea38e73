// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/program/cross_cut.h"
#include "firmware_under_test/planner/strip/strip_feed.h"

namespace kerfbench::planner {

/// The head's three ways over a strip, S0's sections 3.1 to 3.3.
enum class StripMethod {
  kStopAndGo,   ///< Eq. 3: feed a piece, stop, cut across; the next cut runs back.
  kContinuous,  ///< Eq. 4: even feed; the head goes along while it cuts, and back at v_0.
  kMeanSpeed,   ///< Eq. 5: varying feed; the head goes along at the feed's mean over each cut.
};

/// A span of time in which the head has one velocity; the path is made of these.
struct StripSpan {
  enum class Kind { kWait, kCut, kReturn };
  Kind kind{Kind::kWait};
  int piece{};  ///< The piece that is cut, or waited for, or has just been cut; from 1.
  double from_s{}, to_s{};
  /// Head at from_s: x along the feed from where cuts begin, y across from where the first cut begins.
  Eigen::Vector2d from_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d velocity_mm_s{Eigen::Vector2d::Zero()};
  double path_mm{};  ///< G at from_s.
};
std::string_view nameOf(StripSpan::Kind kind);

/// The head at one time.
struct StripState {
  Eigen::Vector2d place_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d velocity_mm_s{Eigen::Vector2d::Zero()};
  double path_mm{};       ///< G(t), eq. 2: the length of the way so far.
  double speed_mm_s{};    ///< dG/dt: 0, v_y, sqrt(v_x² + v_y²) or v_0.
  double off_sheet_mm{};  ///< In a cut: how far along x the head has left the line that the strip carries.
};

/// S0's G(t), eq. 2 to 5, for the first pieces of a strip: without ramps, as the paper has it.
///
/// Eq. 4 gives G in each span as a product of t with a bracket of lengths and speeds, which has no unit; its
/// text and its figure 6 say what is meant: G grows at sqrt(v_x² + v_y²) in cuts, at v_0 on ways back, and is
/// level while the head waits. The paper's times t' let the cuts follow one another without waiting; here cut
/// n begins when n pieces have passed, which is the same where (v_x / v_y)(v_x / v_0 + 1) y0 = L.
/// G is continuous; dG/dt changes at the borders of spans alone, so d²G/dt² is 0 between them, and at each
/// border an impulse of the change of speed.
class StripPath {
 public:
  /// Pieces >= 1. `cut.feed_mm_s` counts for kStopAndGo and kContinuous, `feed` for kMeanSpeed. @throws
  /// PlanError that names each constraint that does not hold, with the first piece at which it does not.
  StripPath(const CrossCut& cut, StripMethod method, const StripFeed& feed, int pieces);

  [[nodiscard]] const std::vector<StripSpan>& spans() const {
    return spans_;
  }                                                                 ///< Without gaps, from 0 s on.
  [[nodiscard]] double endS() const { return spans_.back().to_s; }  ///< End of the last way back.
  /// State at a time in [0, endS()]; at a border that of the span that begins.
  [[nodiscard]] StripState at(double time_s) const;
  /// State within a span, its end included.
  [[nodiscard]] StripState at(const StripSpan& span, double time_s) const;
  /// Largest StripState::off_sheet_mm of all cuts, as a size.
  [[nodiscard]] double farthestOffMm() const;

 private:
  void add(StripSpan::Kind kind, int piece, double to_s, const Eigen::Vector2d& velocity_mm_s);
  void stopAndGo(const CrossCut& cut, int pieces);
  void onTheRun(const CrossCut& cut, int pieces);

  StripMethod method_;
  StripFeed feed_;
  std::vector<StripSpan> spans_;
};

/// Table of a path as CSV, a row each `every_s` and two at each border of spans, before and behind it.
/// every_s > 0.
std::string stripTable(const StripPath& path, double every_s);
/// Spans as text for people, a line each.
std::string stripSpans(const StripPath& path);

}  // namespace kerfbench::planner
