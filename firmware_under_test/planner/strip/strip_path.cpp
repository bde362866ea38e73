// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/strip_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using Kind = StripSpan::Kind;

constexpr double kRounding_s = 1e-9;

/// Sense of a cut across: forth and back in turn.
double senseOf(int piece) { return piece % 2 == 1 ? 1.0 : -1.0; }

/// The cut with the feed that the formulas are to hold for.
CrossCut atFeed(CrossCut cut, double feed_mm_s) {
  cut.feed_mm_s = feed_mm_s;
  return cut;
}

void refuseIf(const std::vector<std::string>& faults) {
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
}

}  // namespace

std::string_view nameOf(StripSpan::Kind kind) {
  switch (kind) {
    case Kind::kWait:
      return "wait";
    case Kind::kCut:
      return "cut";
    case Kind::kReturn:
      return "return";
  }
  return "";
}

StripPath::StripPath(const CrossCut& cut, StripMethod method, const StripFeed& feed, int pieces)
    : method_(method), feed_(method == StripMethod::kMeanSpeed ? feed : StripFeed(cut.feed_mm_s)) {
  if (pieces < 1) throw PlanError(fmt::format("a path takes 1 piece at least, not {}", pieces));
  if (method == StripMethod::kStopAndGo) {
    stopAndGo(cut, pieces);
    return;
  }
  if (method == StripMethod::kContinuous) refuseIf(cut.faults());
  onTheRun(cut, pieces);
}

void StripPath::add(Kind kind, int piece, double to_s, const Vector2d& velocity_mm_s) {
  StripSpan span{kind, piece, 0.0, to_s, Vector2d::Zero(), velocity_mm_s, 0.0};
  if (!spans_.empty()) {
    const StripSpan& before = spans_.back();
    span.from_s = before.to_s;
    const StripState state = at(before, before.to_s);
    span.from_mm = state.place_mm;
    span.path_mm = state.path_mm;
  }
  if (to_s > span.from_s + kRounding_s) spans_.push_back(span);
}

void StripPath::stopAndGo(const CrossCut& cut, int pieces) {
  const double feed_s = cut.piece_mm / cut.feed_mm_s;
  const double half_s = feed_s + cut.width_mm / cut.cut_mm_s;  // T / 2
  for (int n = 1; n <= pieces; ++n) {
    add(Kind::kWait, n, (n - 1) * half_s + feed_s, Vector2d::Zero());
    add(Kind::kCut, n, n * half_s, {0.0, senseOf(n) * cut.cut_mm_s});
  }
}

void StripPath::onTheRun(const CrossCut& cut, int pieces) {
  const double cut_s = cut.width_mm / cut.cut_mm_s;
  for (int n = 1; n <= pieces; ++n) {
    const double from_s = feed_.timeS(n * cut.piece_mm);
    if (!spans_.empty() && spans_.back().to_s > from_s + kRounding_s) {
      throw PlanError(
          fmt::format("piece {} has passed at {:.3f} s, but the head is on its way back until {:.3f} s", n,
                      from_s, endS()));
    }
    const double mean_mm_s = feed_.meanMm_s(from_s, from_s + cut_s);
    CrossCut here = atFeed(cut, mean_mm_s);
    here.piece_mm =
        std::max(here.piece_mm, here.cycleMm());  // The next piece is awaited above, by its own time.
    std::vector<std::string> faults = here.faults();
    for (std::string& fault : faults) fault = fmt::format("piece {}: {}", n, fault);
    refuseIf(faults);
    add(Kind::kWait, n, from_s, Vector2d::Zero());
    add(Kind::kCut, n, from_s + cut_s, {mean_mm_s, senseOf(n) * cut.cut_mm_s});
    add(Kind::kReturn, n, from_s + cut_s + mean_mm_s * cut_s / cut.reposition_mm_s,
        {-cut.reposition_mm_s, 0.0});
  }
}

StripState StripPath::at(double time_s) const {
  const auto next = std::ranges::upper_bound(spans_, time_s, {}, &StripSpan::from_s);
  return at(next == spans_.begin() ? spans_.front() : *(next - 1), time_s);
}

StripState StripPath::at(const StripSpan& span, double time_s) const {
  const double within_s = std::clamp(time_s, span.from_s, span.to_s) - span.from_s;
  const double speed_mm_s = span.velocity_mm_s.norm();
  StripState state{span.from_mm + within_s * span.velocity_mm_s, span.velocity_mm_s,
                   span.path_mm + within_s * speed_mm_s, speed_mm_s, 0.0};
  if (span.kind == Kind::kCut && method_ != StripMethod::kStopAndGo)
    state.off_sheet_mm = within_s * span.velocity_mm_s.x() -
                         (feed_.travelMm(span.from_s + within_s) - feed_.travelMm(span.from_s));
  return state;
}

double StripPath::farthestOffMm() const {
  constexpr int kLooks = 1000;
  double farthest_mm = 0.0;
  for (const StripSpan& span : spans_) {
    for (int i = 0; span.kind == Kind::kCut && i <= kLooks; ++i) {
      const double time_s = span.from_s + (span.to_s - span.from_s) * i / kLooks;
      farthest_mm = std::max(farthest_mm, std::abs(at(span, time_s).off_sheet_mm));
    }
  }
  return farthest_mm;
}

std::string stripTable(const StripPath& path, double every_s) {
  std::string text = "t_s,piece,what,x_mm,y_mm,vx_mm_s,vy_mm_s,G_mm,dG_mm_s,off_sheet_mm\n";
  for (const StripSpan& span : path.spans()) {
    const auto row = [&](double time_s) {
      const StripState s = path.at(span, time_s);
      text += fmt::format("{:.6f},{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f}\n", time_s,
                          span.piece, nameOf(span.kind), s.place_mm.x(), s.place_mm.y(), s.velocity_mm_s.x(),
                          s.velocity_mm_s.y(), s.path_mm, s.speed_mm_s, s.off_sheet_mm);
    };
    row(span.from_s);
    for (auto k = std::llround(std::floor(span.from_s / every_s)) + 1;
         every_s * static_cast<double>(k) < span.to_s - kRounding_s; ++k)
      row(every_s * static_cast<double>(k));
    row(span.to_s);
  }
  return text;
}

std::string stripSpans(const StripPath& path) {
  std::string text = fmt::format("{:>5}  {:<6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>11}\n", "piece", "what",
                                 "from s", "to s", "x mm", "y mm", "G mm", "dG/dt mm/s");
  for (const StripSpan& span : path.spans()) {
    text += fmt::format("{:>5}  {:<6} {:>10.4f} {:>10.4f} {:>10.3f} {:>10.3f} {:>10.3f} {:>11.3f}\n",
                        span.piece, nameOf(span.kind), span.from_s, span.to_s, span.from_mm.x() + 0.0,
                        span.from_mm.y() + 0.0, span.path_mm, span.velocity_mm_s.norm());
  }
  return text;
}

}  // namespace kerfbench::planner
