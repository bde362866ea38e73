// SPDX-License-Identifier: Apache-2.0
// Pieces off a strip by S0, stop-and-go and continuous, timed by the model.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/strip_record.h"
#include "tests/validation/strip_twin.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

using Regime = StripJob::Regime;
using twin::Fidelity;

constexpr const char* kKept = "tests/validation/strip_ten_thousand.csv";

StripJob jobOf(Regime regime) {
  StripJob job;
  job.regime = regime;
  return job;
}

/// Time that formula and ramps leave unexplained: the drives' lag.
double unexplained_s(const StripFigure& figure) {
  const StripJob job = jobOf(figure.regime);
  return figure.cut_s - job.formula_s(figure.pieces) - job.ramps_s(figure.pieces);
}

std::string table(const std::vector<StripFigure>& figures) {
  std::vector<std::vector<std::string>> rows;
  for (const StripFigure& figure : figures) {
    const StripJob job = jobOf(figure.regime);
    rows.push_back({nameOf(figure.regime), std::to_string(figure.pieces), fmt::format("{:.3f}", figure.cut_s),
                    fmt::format("{:.3f}", job.formula_s(figure.pieces)),
                    fmt::format("{:.4f}", job.ramps_s(figure.pieces)),
                    fmt::format("{:.2f}", 1e3 * unexplained_s(figure)),
                    fmt::format("{:.4f}", figure.worst_mm)});
  }
  return markdownTable({"regime", "piece", "off after, s", "formula, s", "ramps and run-ups, s", "rest, ms",
                        "worst off its line, mm"},
                       rows);
}

/// Path of the beam in W over one cycle, two pieces, every millisecond.
Figure headPath(const twin::MachineDescription& machine) {
  constexpr int kEach = 200;  // Number of steps of 10 us.
  StripLine line(machine, jobOf(Regime::kContinuous), Fidelity::kFast);
  line.nextPiece();
  PlotLine path{"beam", {}, true, false};
  int step = 0;
  line.watch([&](double, const Eigen::Vector2d& p_WQ_mm) {
    if (step++ % kEach == 0) path.points.push_back(p_WQ_mm);
  });
  line.nextPiece();
  line.nextPiece();
  LinePlot plot;
  plot.title = "Head over one cycle: two cuts and two ways back";
  plot.x.label = "x along the strip, mm";
  plot.y.label = "y across, mm";
  plot.lines = {path};
  plot.equal_scales = true;
  return {
      "strip-head-path",
      "The beam's way in the machine over one cycle of the continuous regime: with the strip while it cuts, "
      "straight back while the strip goes on (Fig. 5 of the paper).",
      svgOf(plot)};
}

Figure timesPlot(const std::vector<StripFigure>& figures) {
  LinePlot plot;
  plot.title = "Time until the n-th piece is off";
  plot.x = {"pieces", true, 0, 0};
  plot.y = {"s", true, 0, 0};
  for (const Regime regime : {Regime::kStopAndGo, Regime::kContinuous}) {
    PlotLine measured{std::string(nameOf(regime)) + ", twin", {}, false, true};
    PlotLine formula{std::string(nameOf(regime)) + ", formula", {}, true, false};
    for (const StripFigure& figure : figures) {
      if (figure.regime != regime) continue;
      measured.points.emplace_back(figure.pieces, figure.cut_s);
      formula.points.emplace_back(figure.pieces, jobOf(regime).formula_s(figure.pieces));
    }
    plot.lines.push_back(measured);
    plot.lines.push_back(formula);
  }
  return {"strip-times",
          "Dots: pieces of the twin. Lines: 9.478 n s and 3.478 + 6 n s (Fig. 7 of the paper).", svgOf(plot)};
}

/// Largest difference between cut times of the parts put together by hand and those of the whole twin.
double differenceFromTwin_s(const twin::MachineDescription& machine, Regime regime, int pieces) {
  const StripJob job = jobOf(regime);
  StripLine line(machine, job, Fidelity::kFast);
  double worst = 0.0;
  for (const double twin_s : cutTimesOfTwin_s(machine, job, Fidelity::kFast, pieces)) {
    worst = std::max(worst, std::abs(line.nextPiece().cut_s - twin_s));
  }
  return worst;
}

double differenceOfFidelities_s(const twin::MachineDescription& machine, Regime regime, int pieces) {
  const StripJob job = jobOf(regime);
  const auto fast = cutPieces(machine, job, Fidelity::kFast, {pieces});
  const auto reference = cutPieces(machine, job, Fidelity::kReference, {pieces});
  return std::abs(fast.front().cut_s - reference.front().cut_s);
}

void addClaims(Section& section, const std::vector<StripFigure>& figures, const std::string& when) {
  for (const StripFigure& figure : figures) {
    if (figure.pieces < 3) continue;
    section.atMost(fmt::format("{}, piece {}{}: time beyond formula and ramps", nameOf(figure.regime),
                               figure.pieces, when),
                   1e3 * std::abs(unexplained_s(figure)), 5.0, "ms");
    section.atMost(
        fmt::format("{}, pieces up to {}{}: off their lines", nameOf(figure.regime), figure.pieces, when),
        figure.worst_mm, 0.05, "mm");
    section.atMost(fmt::format("{}, pieces up to {}{}: way across without light", nameOf(figure.regime),
                               figure.pieces, when),
                   figure.unlit_mm, 0.0, "mm");
  }
}

}  // namespace

Section stripCutting(const Context& context) {
  const auto machine = stripMachine(context.source_dir);
  const bool quick = context.effort == Effort::kQuick;
  const std::vector<int> marks = quick ? std::vector{1, 3} : std::vector{1, 10, 100};
  std::vector<StripFigure> now;
  for (const Regime regime : {Regime::kStopAndGo, Regime::kContinuous}) {
    const auto some = cutPieces(machine, jobOf(regime), Fidelity::kFast, marks);
    now.insert(now.end(), some.begin(), some.end());
  }
  const auto kept = readFigures(context.source_dir / kKept);

  Section section;
  section.title = "S0: a moving strip cut to length";
  section.markdown =
      "Hu, Hu, Jiang 2014: a strip 800 mm wide, pieces of 1200 mm, v_x = 200 mm/s, v_y = 230 mm/s. A motion "
      "generator of the study makes PUL, DIR, feed and laser pins for `strip-gantry.yaml` from its clock "
      "alone; "
      "the beam runs up beside the strip. A piece is off when the kerf has full depth at the strip's far "
      "edge. "
      "The paper's figures are 9.5 n s and 3.5 + 6 n s, rounded from 9.478 and 3.478; it knows no "
      "ramps.\n\n" +
      table(now) + "\nMeasured once, by `kerfbench-strip --pieces 10000 --write " + kKept + "`:\n\n" +
      table(kept) +
      "\nOf long runs only the ends of each cut are burnt, each piece into a sheet of its own: the whole web "
      "would take 80 GB. The first pieces come off the whole twin at the same times.\n";
  addClaims(section, now, "");
  addClaims(section, kept, " (kept)");
  for (const Regime regime : {Regime::kStopAndGo, Regime::kContinuous}) {
    section.atMost(std::string(nameOf(regime)) + ": cut times, parts against the whole twin",
                   1e3 * differenceFromTwin_s(machine, regime, quick ? 1 : 3), 0.05, "ms", 1e-3);
    section.atMost(std::string(nameOf(regime)) + ": cut times, fast against reference",
                   1e3 * differenceOfFidelities_s(machine, regime, quick ? 1 : 3), 0.05, "ms", 1e-3);
  }
  double growth_kib = 0.0;
  for (const StripFigure& figure : kept) {
    const auto same = [&](const StripFigure& f) { return f.regime == figure.regime && f.pieces == 10; };
    const auto early = std::ranges::find_if(kept, same);
    if (early != kept.end()) growth_kib = std::max(growth_kib, double(figure.peak_kib - early->peak_kib));
  }
  section.atMost("memory from piece 10 to the last (kept)", growth_kib / 1024.0, 1.0, "MiB");
  section.figures = {headPath(machine)};
  std::vector<StripFigure> all = now;
  all.insert(all.end(), kept.begin(), kept.end());
  section.figures.push_back(timesPlot(all));
  return section;
}

}  // namespace kerfbench::validation
