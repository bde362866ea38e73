// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/report/diagnosis_section.h"
#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

std::string environment(const RunReport& report, const Digests& digests) {
  std::string html = "<table><tbody>";
  html += htmlRow("Repeat with", report.repeat_command, true);
  html += htmlRow("Digest", digests.results, true);
  html += htmlRow("Digest of inputs", digests.inputs, true);
  for (const EvidencePart& part : report.evidence)
    html += htmlRow("SHA-256 of " + part.name, part.sha256, true);
  html += htmlRow("Scenario", report.scenario_path, true);
  html += htmlRow("Dieline", report.dieline->path, true);
  html += htmlRow("Firmware", report.firmware);
  html += htmlRow("Signal source", report.source_id);
  html += htmlRow("Machine", report.machine);
  html += htmlRow("Serial number", report.serial_number);
  html += htmlRow("Seed", std::to_string(report.seed));
  html += htmlRow("Virtual time", fmt::format("{:.3f} s", report.virtual_s));
  html +=
      htmlRow("Spot frames", fmt::format("{}, {} lost", report.spot.frames.size(), report.spot.frames_lost));
  for (const auto& [name, version] : report.versions) html += htmlRow(name, version, true);
  html += htmlRow("Host", report.host);
  html += htmlRow("Finished", report.finished);
  html += "</tbody></table>";
  if (!report.scenario_text.empty())
    html += htmlFold("scenario", "Show the scenario as read",
                     "<pre>" + escapeHtml(report.scenario_text) + "</pre>");
  return html;
}

std::string timing(const RunReport& report) {
  if (report.timing.empty()) return {};
  double total_s = 0.0;
  for (const base::StageTime& t : report.timing) total_s += t.wall_s;
  std::string html =
      "<table><thead><tr><th>Stage<th class=num>Wall time, s<th class=num>Share</tr></thead><tbody>";
  for (const base::StageTime& t : report.timing) {
    html += fmt::format("<tr><td>{}<td class=num>{:.2f}<td class=num>{:.0f} %</tr>", escapeHtml(t.stage),
                        t.wall_s, total_s > 0.0 ? 100.0 * t.wall_s / total_s : 0.0);
  }
  html += fmt::format("<tr><td><b>Sum</b><td class=num><b>{:.2f}</b><td></tr></tbody></table>", total_s);
  return html;
}

std::string shownPictures(const RunReport& report) {
  std::string html;
  for (const ReportPicture& picture : report.pictures) {
    if (picture.png.empty()) continue;
    const std::string caption = escapeHtml(picture.caption);
    html += fmt::format(
        "<figure><img class=shown alt='{}' "
        "src='data:image/png;base64,{}'><figcaption>{}</figcaption></figure>",
        caption, base64(picture.png), caption);
  }
  return html;
}

std::string filesBeside(const RunReport& report) {
  std::string list;
  for (const ReportPicture& picture : report.pictures) {
    list += fmt::format("<li><a href='{}'>{}</a> {}</li>", escapeHtml(picture.file), escapeHtml(picture.file),
                        escapeHtml(picture.caption));
  }
  return list.empty() ? list : "<ul>" + list + "</ul>";
}

std::string reportHeader(const RunReport& report) {
  const std::string facts = htmlFacts({{"Scenario", report.scenario},
                                       {"Firmware", report.firmware},
                                       {"Machine", report.machine},
                                       {"Serial number", report.serial_number},
                                       {"Seed", std::to_string(report.seed)},
                                       {"Imperfections", report.model.imperfections},
                                       {"Model", report.model.twin},
                                       {"Finished", report.finished}});
  const inspect::Verdict verdict = report.result.verdict;
  return fmt::format(
      "<a class=skip href='#answer'>To the answer</a><header id=answer class={}><div class=big>{}</div>"
      "<h1>{}</h1>{}<div class=facts>{}</div></header>\n",
      verdictClass(verdict), inspect::verdictName(verdict), escapeHtml(headlineSentence(report)),
      headlineList(report), facts);
}

/// A section of the page, in its order; empty ones are left out.
struct PageSection {
  std::string_view title;
  std::string body;
};

std::string contentsOf(const std::vector<PageSection>& sections) {
  std::string list;
  for (const PageSection& section : sections)
    if (!section.body.empty())
      list += fmt::format("<li><a href='#{}'>{}</a></li>", sectionId(section.title), section.title);
  return list.empty() ? list : "<nav class=contents aria-label=Contents><ul>" + list + "</ul></nav>\n";
}

}  // namespace

std::string htmlReport(const RunReport& report, const Digests& digests) {
  const std::vector<PageSection> sections{{"What to do next", nextStepsList(report)},
                                          {"Problems of the evidence", problemsList(report)},
                                          {kFailuresTitle, failuresSection(report)},
                                          {"Likely causes", diagnosisSection(report)},
                                          {"How the run was stopped", safeTimelineFigure(report)},
                                          {"Checks", checksSection(report)},
                                          {"The cut against the dieline", dielineFigures(report)},
                                          {"All that the camera saw", mosaicFigure(report)},
                                          {"Worst places", worstPlaces(report)},
                                          {"The cut over time", motionSection(report)},
                                          {"Stillness along x, cut by cut", stillnessFigures(report)},
                                          {"Pulse timing", pulseFigures(report)},
                                          {"Entities", entityTable(report)},
                                          {"What the measurement is worth", uncertaintySection(report)},
                                          {"The drawing", drawingFigure(report)},
                                          {"Pictures of the machine", shownPictures(report)},
                                          {"Files beside this report", filesBeside(report)},
                                          {"Machine", modelSection(report)},
                                          {"What was run", environment(report, digests)},
                                          {"Where the time went", timing(report)},
                                          {"Record to sign", recordSection(report, digests)}};
  std::string page = htmlPageHead(
      fmt::format("{} – {}", inspect::verdictName(report.result.verdict), report.scenario), {}, pageRules());
  page += reportHeader(report) + lostStepsBanner(report) + contentsOf(sections) + dielineSymbol(report);
  for (const PageSection& section : sections) page += htmlSection(section.title, section.body);
  return page + "<script>" + std::string(kReportScript) + "</script>" + std::string(kHtmlPageEnd);
}

}  // namespace kerfbench::report
