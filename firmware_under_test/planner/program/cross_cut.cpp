// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/cross_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::planner {
namespace {

double highestByReach(const CrossCut& cut) { return cut.reach_mm * cut.cut_mm_s / cut.width_mm; }

/// Positive root of v² / v_0 + v = L v_y / y0.
double highestByPiece(const CrossCut& cut) {
  const double v0 = cut.reposition_mm_s;
  return 0.5 * v0 * (std::sqrt(1.0 + 4.0 * cut.piece_mm * cut.cut_mm_s / (cut.width_mm * v0)) - 1.0);
}

}  // namespace

double CrossCut::carriedMm() const { return feed_mm_s * width_mm / cut_mm_s; }

double CrossCut::cycleMm() const { return carriedMm() * (feed_mm_s / reposition_mm_s + 1.0); }

double CrossCut::highestFeedMm_s() const { return std::min(highestByReach(*this), highestByPiece(*this)); }

std::vector<std::string> CrossCut::unusable() const {
  std::vector<std::string> faults;
  const std::pair<const char*, double> values[] = {{"--pitch, the length of a piece,", piece_mm},
                                                   {"--width of the strip", width_mm},
                                                   {"--x-max less --x-min, the reach of the head,", reach_mm},
                                                   {"--belt-speed, the feed,", feed_mm_s},
                                                   {"--mark-speed, that of the cut,", cut_mm_s},
                                                   {"--jump-speed, that of the way back,", reposition_mm_s}};
  for (const auto& [name, value] : values) {
    if (!(std::isfinite(value) && value > 0.0))
      faults.push_back(fmt::format("{} must be > 0, but is {:g}", name, value));
  }
  return faults;
}

std::vector<std::string> CrossCut::faults() const {
  std::vector<std::string> faults = unusable();
  if (!faults.empty()) return faults;
  constexpr double kRounding = 1.0 + 1e-9;
  if (carriedMm() > reach_mm * kRounding) {
    faults.push_back(
        fmt::format("the strip carries the head {:.1f} mm while it cuts {:g} mm at {:g} mm/s (v_x y0 / v_y), "
                    "its reach is "
                    "{:g} mm: {:.1f} mm/s at most",
                    carriedMm(), width_mm, cut_mm_s, reach_mm, highestByReach(*this)));
  }
  if (cycleMm() > piece_mm * kRounding) {
    faults.push_back(
        fmt::format("{:.1f} mm of strip pass during a cut and the way back at {:g} mm/s ((v_x / v_y)(v_x / "
                    "v_0 + 1) y0), a "
                    "piece has {:g} mm: {:.1f} mm/s at most",
                    cycleMm(), reposition_mm_s, piece_mm, highestByPiece(*this)));
  }
  return faults;
}

double CrossCut::stopAndGoS(double pieces) const {
  return pieces * (piece_mm / feed_mm_s + width_mm / cut_mm_s);
}

double CrossCut::continuousS(double pieces) const {
  return pieces * piece_mm / feed_mm_s + width_mm / cut_mm_s;
}

std::optional<CrossCut> crossCutOf(const std::vector<Segment>& path, const MachineParameters& machine,
                                   const JobParameters& job) {
  if (path.size() != 1 || path.front().isArc() || job.stop_and_go || job.units < 2) return std::nullopt;
  const Eigen::Vector2d line = path.front().end_mm - path.front().start_mm;
  if (!(job.belt_speed_mm_s > 0.0) || std::abs(line.x()) > 0.01 * std::abs(line.y())) return std::nullopt;
  return CrossCut{job.pitch_mm,        std::abs(line.y()),  machine.field_max_mm[0] - machine.field_min_mm[0],
                  job.belt_speed_mm_s, job.mark_speed_mm_s, job.jump_speed_mm_s};
}

}  // namespace kerfbench::planner
