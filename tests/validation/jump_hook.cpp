// SPDX-License-Identifier: Apache-2.0
// S2: a straight jump at the galvo's limits leaves a hook at the ends of the marks; an arc does not.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "hil/machine_file/machine_file.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/machine_run.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

using Eigen::Vector2d;

// S2's galvo: 1 m/s, 10 m/s², R = 5 mm.
constexpr double kTop_mm_s = 1000.0;
constexpr double kAcceleration_mm_s2 = 10'000.0;
constexpr double kRadius_mm = 5.0;
constexpr double kMark_mm = 20.0;

enum class Jump { kStraight, kArcs };

// A mark along +x, a jump of `jump_mm` along +y, a mark back along -x.
Motion markJumpMark(Jump kind, double jump_mm, double jump_mm_s) {
  const double radius_mm = std::min(kRadius_mm, 0.5 * jump_mm);
  const double mark_mm_s = std::sqrt(kAcceleration_mm_s2 * radius_mm);  // Speed that the arc allows.
  const Vector2d b(0.0, -0.5 * jump_mm);
  const Vector2d c(0.0, 0.5 * jump_mm);
  const Speeds constant{mark_mm_s, mark_mm_s, mark_mm_s};
  Motion motion(b - Vector2d(2.0 * kMark_mm, 0.0));
  motion.line(b - Vector2d(kMark_mm, 0.0), {0.0, mark_mm_s, mark_mm_s, kAcceleration_mm_s2}, false);
  motion.line(b, constant, true);
  if (kind == Jump::kStraight) {
    motion.line(c, {jump_mm_s, jump_mm_s, jump_mm_s}, false);
  } else {
    const Vector2d up(0.0, radius_mm);
    motion.arc(b + up, 0.5 * std::numbers::pi, constant, false);
    if (jump_mm > 2.0 * radius_mm) {
      motion.line(c + Vector2d(radius_mm, -radius_mm), {mark_mm_s, jump_mm_s, mark_mm_s, kAcceleration_mm_s2},
                  false);
    }
    motion.arc(c - up, 0.5 * std::numbers::pi, constant, false);
  }
  motion.line(c - Vector2d(kMark_mm, 0.0), constant, true);
  motion.line(c - Vector2d(2.0 * kMark_mm, 0.0), {mark_mm_s, mark_mm_s, 0.0, kAcceleration_mm_s2}, false);
  return motion;
}

struct Hook {
  double end_mm{}, start_mm{};  ///< Distances of the first mark's end and the second mark's start.
  std::vector<Vector2d> lit;
  [[nodiscard]] double worst_mm() const { return std::max(end_mm, start_mm); }
};

// Hook of a run. The laser is delayed by the mirrors' tracking delay, as by the controller, and by nothing
// else.
Hook hookOf(const twin::MachineDescription& machine, const Motion& motion) {
  constexpr double kTail_s = 5e-3;
  constexpr double kNear_mm = 5.0;  // Distance from the mark's end at the jump.
  const auto run = runMachine(machine, restingWeb(), motion, kTail_s, twin::Fidelity::kReference);
  const auto lit_s = motion.lit_s();
  const double delay_s = machine.controller.tracking_delay_s;
  Hook hook;
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    for (std::size_t mark = 0; mark < lit_s.size(); ++mark) {
      if (run.time_s[i] < lit_s[mark].first + delay_s || run.time_s[i] > lit_s[mark].second + delay_s)
        continue;
      const Vector2d& spot = run.spot_mm[i];
      hook.lit.push_back(spot);
      if (!(std::abs(spot.x()) < kNear_mm)) continue;
      double& worst = mark == 0 ? hook.end_mm : hook.start_mm;
      raiseTo(worst, motion.distance_mm(spot, mark));
    }
    if (run.time_s[i] > lit_s[0].second + delay_s && run.time_s[i - 1] <= lit_s[0].second + delay_s) {
      hook.lit.push_back(Vector2d::Constant(std::nan("")));
    }
  }
  return hook;
}

Figure pathFigure(const Hook& straight, const Hook& arcs, double jump_mm) {
  LinePlot plot{fmt::format("Start of the mark after a jump of {:g} mm", jump_mm),
                {"x, mm", false, -0.5, 0.05},
                {"y, mm", false, 0.5 * jump_mm - 0.1, 0.5 * jump_mm + 0.1},
                {}};
  plot.lines.push_back({"straight jump at the galvo's limits, lit", straight.lit});
  plot.lines.push_back({"arc, straight, arc (S2), lit", arcs.lit});
  plot.lines.push_back({"the mark", {{0.0, 0.5 * jump_mm}, {-kMark_mm, 0.5 * jump_mm}}});
  return {"jump-hook-path", plot.title, svgOf(plot)};
}

}  // namespace

Section jumpHook(const Context& context) {
  const auto machine = machine_file::readMachine(context.source_dir / "fixtures/machines/two-mirror.yaml");
  const double step_mm =
      2.0 * machine.galvo_x.step * (machine.head.throw_mm + machine.head.mirror_spacing_mm);
  const auto& profile = machine.galvo_x.profile;
  const double limit_mm_s = 0.95 * step_mm / (profile.width_s + profile.space_s);
  const std::vector<double> jumps_mm =
      context.effort == Effort::kQuick ? std::vector{20.0} : std::vector{1.0,  2.0,  3.0,  5.0,  7.0,  10.0,
                                                                         15.0, 20.0, 30.0, 50.0, 70.0, 100.0};
  PlotLine paper{fmt::format("straight, S2's top speed {:g} m/s", kTop_mm_s * 1e-3), {}, true, true};
  PlotLine limit{fmt::format("straight, the most pulses that the drive takes, {:.2g} m/s", limit_mm_s * 1e-3),
                 {},
                 true,
                 true};
  PlotLine arcs{"arc, straight, arc with S2's speed planning", {}, true, true};
  double least_limit = 1e9, worst_arcs = 0.0;
  std::vector<std::vector<std::string>> rows;
  Section section;
  for (const double jump_mm : jumps_mm) {
    const Motion at_limit = markJumpMark(Jump::kStraight, jump_mm, limit_mm_s);
    const Hook of_paper = hookOf(machine, markJumpMark(Jump::kStraight, jump_mm, kTop_mm_s));
    const Hook of_limit = hookOf(machine, at_limit);
    const Hook of_arcs = hookOf(machine, markJumpMark(Jump::kArcs, jump_mm, kTop_mm_s));
    paper.points.emplace_back(jump_mm, of_paper.worst_mm());
    limit.points.emplace_back(jump_mm, of_limit.worst_mm());
    arcs.points.emplace_back(jump_mm, of_arcs.worst_mm());
    least_limit = std::min(least_limit, of_limit.worst_mm());
    raiseTo(worst_arcs, of_arcs.worst_mm());
    rows.push_back({fmt::format("{:g}", jump_mm), fmt::format("{:.4f}", of_paper.worst_mm()),
                    fmt::format("{:.4f}", of_limit.worst_mm()), fmt::format("{:.4f}", of_arcs.worst_mm())});
    if (jump_mm == 20.0) section.figures.push_back(pathFigure(of_limit, of_arcs, jump_mm));
  }
  section.title = "The hook of a straight jump (S2)";
  section.markdown = fmt::format(
      "A mark, a jump across it, a mark back; the machine is `two-mirror.yaml`, the pulses are of a motion "
      "generator of the\nvalidation's own that neither smooths nor waits. The laser knows the mirrors' "
      "tracking delay ({:.0f} µs). The hook is the\nlargest distance of the lit spot from its mark within 5 "
      "mm "
      "of the jump, in mm. One pulse is {:.4f} mm. Marks at what\nS2's arc allows: sqrt(a R), a = 10 m/s², R "
      "= 5 mm or half the jump.\n\n",
      machine.controller.tracking_delay_s * 1e6, step_mm);
  section.markdown += markdownTable({"jump, mm", paper.name, limit.name, arcs.name}, rows);
  section.atLeast("smallest hook of a straight jump at the drive's limit: the effect is there", least_limit,
                  0.05, "mm");
  section.atMost("largest deviation with S2's arcs: not more than one pulse", worst_arcs, step_mm, "mm");
  LinePlot plot{
      "Hook of a jump", {"jump, mm", true}, {"hook, mm"}, {paper, limit, arcs}, {{0.05, "0.05 mm"}}};
  section.figures.push_back({"jump-hook", "Hook over the length of the jump", svgOf(plot)});
  return section;
}

}  // namespace kerfbench::validation
