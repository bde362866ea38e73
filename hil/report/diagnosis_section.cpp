// SPDX-License-Identifier: Apache-2.0
#include "hil/report/diagnosis_section.h"

#include <cmath>

#include <fmt/format.h>

#include "hil/report/html_text.h"

namespace kerfbench::report {

OrderedJson diagnosisJson(const RunReport& report) {
  const diagnose::Diagnosis& diagnosis = report.diagnosis;
  OrderedJson j;
  j["sentence"] = diagnosis.sentence;
  j["deviation_rms_mm"] = rounded(diagnosis.deviation_mm);
  j["causes"] = OrderedJson::array();
  for (const diagnose::Cause& cause : diagnosis.causes) {
    j["causes"].push_back({{"cause", cause.key},
                           {"size", rounded(cause.size.value)},
                           {"expanded_uncertainty", rounded(cause.size.U)},
                           {"unit", cause.size.unit},
                           {"share_explained", rounded(cause.share)},
                           {"left_rms_mm", rounded(cause.left_mm)},
                           {"direct", cause.direct},
                           {"gain", rounded(cause.score)},
                           {"not_told_from", cause.instead},
                           {"sentence", cause.sentence}});
  }
  return j;
}

std::vector<std::string> diagnosisLines(const RunReport& report) {
  const diagnose::Diagnosis& diagnosis = report.diagnosis;
  std::vector<std::string> lines;
  const bool is_explained = !diagnosis.causes.empty() && diagnose::explainsMost(diagnosis.causes.front());
  if (!is_explained && !diagnosis.sentence.empty()) lines.push_back(diagnosis.sentence);
  for (const diagnose::Cause& cause : diagnosis.causes)
    lines.push_back((!is_explained   ? "A part of it: "
                     : lines.empty() ? "Likely cause: "
                                     : "Also: ") +
                    cause.sentence);
  return lines;
}

std::string diagnosisSection(const RunReport& report) {
  const diagnose::Diagnosis& diagnosis = report.diagnosis;
  if (diagnosis.causes.empty())
    return diagnosis.sentence.empty() ? std::string() : "<p>" + escapeHtml(diagnosis.sentence) + "</p>";
  std::string html =
      diagnose::explainsMost(diagnosis.causes.front()) ? "" : "<p>" + escapeHtml(diagnosis.sentence) + "</p>";
  html += "<table><tr><th>Cause<th>Size<th>Explains<th>Left, RMS</tr>";
  for (const diagnose::Cause& cause : diagnosis.causes) {
    const std::string size = cause.size.unit.empty() ? std::string("–")
                                                     : fmt::format("{:.4g} ± {:.2g} {}", cause.size.value,
                                                                   cause.size.U, cause.size.unit);
    html += fmt::format("<tr><td>{}<td>{}<td>{}<td>{}</tr>", escapeHtml(cause.sentence), escapeHtml(size),
                        std::isfinite(cause.share) ? fmt::format("{:.0f} %", 100.0 * cause.share) : "–",
                        std::isfinite(cause.left_mm) ? fmt::format("{:.3f} mm", cause.left_mm) : "–");
  }
  return html + "</table>";
}

}  // namespace kerfbench::report
