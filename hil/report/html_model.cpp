// SPDX-License-Identifier: Apache-2.0
// What the model alone knows of a run.
#include <fmt/format.h>

#include <algorithm>

#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

std::string drawnTable(const ModelFacts& model) {
  if (model.sampled.empty()) return {};
  std::string html =
      "<table><thead><tr><th>Sampled for this run<th class=num>Off the machine file "
      "by<th>Unit</tr></thead><tbody>";
  for (const SampledValue& sampled : model.sampled) {
    html += fmt::format("<tr><td>{}<td class=num>{:.6g}<td>{}</tr>", escapeHtml(sampled.name), sampled.value,
                        escapeHtml(sampled.unit));
  }
  return html + "</tbody></table>";
}

std::string lostStepsTable(const ModelFacts& model) {
  if (model.lost_steps.empty()) return {};
  std::string html =
      "<table><thead><tr><th>Axis<th class=num>Time, s<th class=num>Place<th>Unit<th class=num>Full steps "
      "lost</tr></thead><tbody>";
  const std::size_t rows = std::min(model.lost_steps.size(), kMostRows);
  for (std::size_t i = 0; i < rows; ++i) {
    const LostStepsNote& lost = model.lost_steps[i];
    html +=
        fmt::format("<tr><td>{}<td class=num>{:.5f}<td class=num>{:.6g}<td>{}<td class='num hit'>{}</tr>",
                    escapeHtml(lost.axis), lost.time_s, lost.place, escapeHtml(lost.unit), lost.full_steps);
  }
  html += "</tbody></table>";
  if (rows < model.lost_steps.size()) {
    html += fmt::format("<p class=note>The first {} of {}; all are in verdict.json.</p>", rows,
                        model.lost_steps.size());
  }
  return html;
}

}  // namespace

std::string lostStepsSentence(const ModelFacts& model) {
  if (model.lost_steps.empty()) return {};
  const LostStepsNote& first = model.lost_steps.front();
  return fmt::format(
      "The machine lost steps: {} {} full steps at {:.3f} s{}.", first.axis, first.full_steps, first.time_s,
      model.lost_steps.size() == 1 ? std::string()
                                   : fmt::format(" (the first of {} times)", model.lost_steps.size()));
}

std::string lostStepsBanner(const RunReport& report) {
  const std::string sentence = lostStepsSentence(report.model);
  if (sentence.empty()) return {};
  return fmt::format(
      "<ul class='problems lost'><li><b>{}</b> No check judges this: the verdict comes from pixels and pins. "
      "See "
      "Machine.</li></ul>\n",
      escapeHtml(sentence));
}

std::string modelSection(const RunReport& report) {
  const ModelFacts& model = report.model;
  if (model.imperfections.empty()) return {};
  return fmt::format(
             "<p>Imperfections <b>{}</b>, seed {}, model <b>{}</b>. This is what the model knows of itself; "
             "nothing here was measured or judged.</p>",
             escapeHtml(model.imperfections), report.seed, escapeHtml(model.twin)) +
         lostStepsTable(model) + partingSection(report) + drawnTable(model);
}

}  // namespace kerfbench::report
