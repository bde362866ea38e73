// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/timed_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::judge {
namespace {

constexpr double kCutPitch_s = 5e-4;

}  // namespace

TimedCuts::TimedCuts(const AskedPath& asked, const SheetPath& sheet, const ProgramPath& program,
                     const std::vector<inspect::GateInterval>& gates, const Options& options)
    : program_(program), options_(options) {
  const auto& pieces = program.pieces();
  paired_ = !pieces.empty() && gates.size() == pieces.size() * static_cast<std::size_t>(options.units);
  for (std::size_t i = 0; i < gates.size(); ++i) {
    Cut cut;
    cut.on_s = gates[i].on_s;
    cut.off_s = gates[i].off_s;
    if (paired_) {
      cut.unit = static_cast<int>(i / pieces.size());
      cut.reversed = options.alternate && cut.unit % 2 == 1;
      const std::size_t place = i % pieces.size();
      cut.piece = &pieces[cut.reversed ? pieces.size() - 1 - place : place];
      sample(asked, sheet, cut);
      cuts_.push_back(std::move(cut));
      continue;
    }
    // Which unit it was is told by where it lies.
    for (int unit = 0; unit < options.units; ++unit) {
      Cut here = cut;
      here.unit = unit;
      sample(asked, sheet, here);
      cuts_.push_back(std::move(here));
    }
  }
}

void TimedCuts::sample(const AskedPath& asked, const SheetPath& sheet, Cut& cut) const {
  for (double time_s = cut.on_s; time_s <= cut.off_s; time_s += kCutPitch_s) {
    const diagnose::HeadState head = asked.at(time_s);
    if (!head.known()) continue;
    cut.time_s.push_back(time_s);
    cut.p_S_mm.push_back(sheet.inSheet(cut.unit, time_s, head.p_mm));
  }
}

std::optional<TimedCuts::Passing> TimedCuts::passing(int unit, int entity, const Eigen::Vector2d& p_S_mm,
                                                     const Eigen::Vector2d& normal, double reach_mm) const {
  const bool is_named = paired_ && program_.isNamed();
  Crossing crossing(p_S_mm, normal, reach_mm);
  double time_s = 0.0;
  for (const Cut& cut : cuts_) {
    if (cut.unit != unit || (is_named && !cut.piece->has(entity))) continue;
    for (std::size_t i = 1; i < cut.p_S_mm.size(); ++i) {
      if (crossing.take(cut.p_S_mm[i - 1], cut.p_S_mm[i]))
        time_s = cut.time_s[i - 1] + crossing.share() * (cut.time_s[i] - cut.time_s[i - 1]);
    }
  }
  if (std::isnan(crossing.offset_mm())) return std::nullopt;
  return Passing{time_s, crossing.offset_mm()};
}

}  // namespace kerfbench::judge
