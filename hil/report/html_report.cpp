// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/report/diagnosis_section.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {

const std::string_view kReportCss = R"css(
:root{--bg:#fff;--fg:#1c2430;--mute:#5d6878;--line:#d9dee6;--card:#f6f8fa;--pass:#137a3e;--fail:#b3122b;--np:#9a5b00;
--inv:#5b3fa0;--nom:#9aa5b4;--b0:#1a7f5a;--b1:#6c9a1f;--b2:#c99700;--b3:#dd6b10;--b4:#c4001a;--acc:#1f5fbf}
@media(prefers-color-scheme:dark){:root{--bg:#12161c;--fg:#e4e9f0;--mute:#97a3b4;--line:#2d3643;--card:#1a2029;
--pass:#35b56c;--fail:#f0566c;--np:#e0a13a;--inv:#a58bf0;--nom:#657387;--b0:#35b58a;--b1:#a1c83f;--b2:#e8bd2f;--b3:#f59240;
--b4:#ff5a6e;--acc:#6aa5ff}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--fg);font:15px/1.45 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
main{max-width:1120px;margin:0 auto;padding:24px 28px 48px}
header{display:grid;grid-template-columns:auto 1fr;gap:6px 24px;align-items:center;border-left:10px solid;padding:14px 20px;
background:var(--card);border-radius:6px}
header .big{font-size:42px;font-weight:750;letter-spacing:.01em;line-height:1.1;white-space:nowrap}
header p{margin:0;font-size:17px} header .facts{grid-column:1/-1;color:var(--mute);font-size:14px}
.pass{color:var(--pass)}.fail{color:var(--fail)}.notproven{color:var(--np)}.invalid{color:var(--inv)}
header.pass,header.fail,header.notproven,header.invalid{border-color:currentColor}
header p,header .facts{color:var(--fg)}header .facts{color:var(--mute)}
h2{font-size:20px;margin:34px 0 10px;border-bottom:1px solid var(--line);padding-bottom:4px}
table{border-collapse:collapse;width:100%;font-size:14px;margin:8px 0}
th,td{text-align:left;padding:6px 9px;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--mute);font-weight:600;font-size:13px}
.num{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.hit{color:var(--fail);font-weight:650} small{color:var(--mute)}
table.checks td:first-child{width:44%}.checks .num,.checks td.v{font-size:13px}table.checks td,table.checks th{padding:7px 6px}
td.v{font-weight:700;white-space:nowrap}td.mute{color:var(--mute);font-weight:400} td .why{color:var(--mute);font-size:13px;display:block;margin-top:2px}
.note{color:var(--mute);font-size:13px;margin:6px 0 0}
ul.problems{border-left:5px solid var(--inv);background:var(--card);padding:10px 10px 10px 30px;margin:12px 0}
ul.lost{border-left-color:var(--np)}
figure{margin:0} .shown{max-width:100%;height:auto} figcaption{font-size:13px;color:var(--mute);margin-top:3px}
.panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(330px,1fr));gap:16px}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(310px,1fr));gap:14px;margin:10px 0}
.patches{display:grid;grid-template-columns:repeat(auto-fill,minmax(165px,1fr));gap:14px}
svg{display:block;width:100%}svg.die{max-height:640px;background:var(--card);border-radius:6px}
svg.patch{border-radius:4px;background:#000;aspect-ratio:1}
svg.gauge{width:126px;height:16px}
.nominal,.b0,.b1,.b2,.b3,.b4,.missing,.place,.stray{fill:none;vector-effect:non-scaling-stroke}
.nominal{stroke:var(--nom);stroke-width:1}
.b0,.b1,.b2,.b3,.b4{stroke-width:1.8;stroke-linecap:round;stroke-linejoin:round}
.b0{stroke:var(--b0)}.b1{stroke:var(--b1)}.b2{stroke:var(--b2)}.b3{stroke:var(--b3)}.b4{stroke:var(--b4);stroke-width:2.6}
.missing{stroke:#c030c0;stroke-width:4;stroke-linecap:round;stroke-dasharray:2 6}
.place{stroke:var(--fg);stroke-width:1.4}.placeno{fill:var(--fg);font-weight:700}.stray{stroke:var(--b4);stroke-width:2.5}
.px{image-rendering:pixelated;image-rendering:crisp-edges;image-rendering:pixelated}
.pn,.pt{fill:none;vector-effect:non-scaling-stroke;stroke:#20a8ff;stroke-width:1.6}
.pt{stroke:#ff5a3c;stroke-dasharray:4 3;stroke-width:1.3}
.legend{display:flex;flex-wrap:wrap;gap:4px 18px;font-size:13px;margin:6px 0 10px}
.key{display:inline-flex;align-items:center;gap:6px}.key i{width:22px;height:0;border-top:4px solid}
.k0{color:var(--b0)}.k1{color:var(--b1)}.k2{color:var(--b2)}.k3{color:var(--b3)}.k4{color:var(--b4)}.kn{color:var(--nom)}
.km{color:#c030c0;border-top-style:dotted!important}.key i.ks{width:12px;height:12px;border:2.5px solid var(--b4);border-radius:50%}
.frame{fill:var(--card);stroke:var(--line)}.zero{stroke:var(--mute);stroke-width:.6}
.lim{stroke:var(--fail);stroke-width:1.2}.plot .lim{stroke-dasharray:4 3}
.fit{stroke:var(--fg);stroke-width:1.6}.dots{stroke:var(--acc);stroke-width:3;stroke-linecap:round;fill:none}
.sheetdots{stroke:var(--b3);stroke-width:5}.sheetword{color:var(--b3);font-weight:650}.spotword{color:var(--acc);font-weight:650}
.tick{fill:var(--mute);font-size:10px}.bar{fill:var(--acc)}.barbad{fill:var(--fail)}
.gauge .ok{fill:var(--pass);opacity:.35}.gauge .band{fill:var(--np);opacity:.45}.gauge .bad{fill:var(--fail);opacity:.35}
.grid{stroke:var(--line);stroke-width:.6}
.figs{display:grid;grid-template-columns:repeat(auto-fill,minmax(440px,1fr));gap:18px 22px;margin:12px 0}
.gauge .unc{stroke:var(--fg);stroke-width:2}.gauge .val{fill:var(--fg)}
pre{background:var(--card);border-radius:6px;padding:10px 14px;overflow:auto;font-size:13px;white-space:pre-wrap}
code{font-size:13px;overflow-wrap:anywhere} a{color:var(--acc)} summary{cursor:pointer;color:var(--acc);margin:6px 0}
@media(max-width:700px){header{grid-template-columns:1fr}main{padding:12px}}
@media print{:root{--bg:#fff;--fg:#000;--mute:#444;--line:#bbb;--card:#fff;--pass:#137a3e;--fail:#b3122b;--np:#9a5b00;
--inv:#5b3fa0;--nom:#999;--acc:#1f5fbf}
main{max-width:none;padding:0}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
figure,tr,header{break-inside:avoid}h2{break-after:avoid}summary{display:none}body{font-size:12px}}
)css";

const std::string_view kHtmlPageEnd = "</main></body></html>\n";

std::string htmlPageHead(std::string_view title, std::string_view more_css) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content='width=device-width'>"
      "<meta name=color-scheme content='light "
      "dark'><title>{}</title><style>{}{}</style></head><body><main>\n",
      escapeHtml(title), kReportCss, more_css);
}

namespace {

constexpr std::size_t kMaxEntityRows = 300;

std::string checkTable(const RunReport& report) {
  std::string html =
      "<table class=checks><thead><tr><th>Check<th>Verdict<th class=num>Value<th class=num>Limit<th "
      "class=num>U "
      "(k = 2)<th class=num>Guard w<th>Against limit</tr></thead><tbody>";
  for (const inspect::Check& c : report.result.checks) {
    html += fmt::format(
        "<tr><td><b>{}</b> <small>{}</small><span class=why>{}</span><td class='v {}'>{}<td class=num>{}"
        "<td class=num>{} {}<td class=num>{}<td class=num>{}<td>{}</tr>",
        escapeHtml(c.title), escapeHtml(c.name), escapeHtml(c.explanation), verdictClass(c.verdict),
        inspect::verdictName(c.verdict), checkNumber(c, c.value), c.upper ? "≤" : "≥",
        checkNumber(c, c.limit), c.u > 0.0 ? checkNumber(c, c.u) : "–",
        c.guard > 0.0 ? checkNumber(c, c.guard) : "–", gaugeSvg(c));
  }
  for (const inspect::Unjudged& u : report.result.unjudged) {
    html += fmt::format(
        "<tr><td><b>{}</b> <small>{}</small><span class=why>{}</span><td class='v mute' colspan=6>{}</tr>",
        escapeHtml(u.title), escapeHtml(u.name), escapeHtml(u.reason),
        u.applies ? "not judged" : "not applicable");
  }
  return html +
         "</tbody></table><p class=note>Rule (JCGM 106): PASS if the value is inside limit − w, FAIL if it "
         "is outside "
         "limit + w, NOT PROVEN between, INVALID if it could not be measured. The value of a worst-of-many "
         "check "
         "is corrected for being an extreme of noisy readings, and its U belongs to that value.</p>";
}

std::string entityTable(const RunReport& report) {
  std::vector<const inspect::EntityResult*> rows;
  for (const inspect::EntityResult& e : report.result.entities) rows.push_back(&e);
  const auto badness = [&](const inspect::EntityResult* e) {
    const double offset = std::isfinite(e->worst_mm) ? std::abs(e->worst_mm) / report.limits.path_mm : 0.0;
    return std::max(offset, 10.0 * (1.0 - e->coverage));
  };
  std::stable_sort(rows.begin(), rows.end(), [&](auto* a, auto* b) { return badness(a) > badness(b); });
  const auto number = [](double v, double scale, int digits) {
    return std::isfinite(v) ? fmt::format("{:.{}f}", scale * v, digits) : std::string("–");
  };
  const auto withU = [&](double value, double U) {
    return std::isfinite(value) ? number(value, 1e3, 1) + " ± " + number(U, 1e3, 1) : std::string("–");
  };
  std::string html =
      "<table><thead><tr><th>Entity<th>Process<th>Origin<th class=num>Worst, µm<th class=num>RMS, µm<th "
      "class=num>Coverage, %<th class=num>Width, µm<th class=num>Circularity, µm<th "
      "class=num>Passes</tr></thead><tbody>";
  for (std::size_t i = 0; i < std::min(rows.size(), kMaxEntityRows); ++i) {
    const inspect::EntityResult& e = *rows[i];
    const auto index = static_cast<std::size_t>(e.entity);
    const bool known = index < report.dieline->entities.size();
    html += fmt::format(
        "<tr><td>unit {}, E{}<td>{}<td>{} <small>{}</small><td class='num{}'>{}<td class=num>{}<td "
        "class='num{}'>{}<td class=num>{}<td class=num>{}<td class='num{}'>{}</tr>",
        e.unit, e.entity, known ? dieline::processName(report.dieline->entities[index].process) : "",
        known ? escapeHtml(report.dieline->entities[index].origin) : std::string(),
        known ? escapeHtml(report.dieline->entities[index].layer) : std::string(),
        std::abs(e.worst_mm) > report.limits.path_mm ? " hit" : "", withU(e.worst_mm, e.worst_U_mm),
        withU(e.rms_mm, e.rms_U_mm),
        known && report.dieline->entities[index].process != dieline::Process::kPerforation &&
                e.uncut_mm > report.limits.uncut_mm
            ? " hit"
            : "",
        number(e.coverage, 100.0, 1), withU(e.width_mm, e.width_U_mm),
        withU(e.circularity_mm, e.circularity_U_mm), e.passes > report.limits.passes ? " hit" : "",
        number(e.passes, 1.0, 2));
  }
  html += "</tbody></table>";
  if (rows.size() > kMaxEntityRows) {
    html += fmt::format("<p class=note>The worst {} of {} entities; all are in verdict.json.</p>",
                        kMaxEntityRows, rows.size());
  }
  return html;
}

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
  html += htmlRow("Seed", std::to_string(report.seed));
  html += htmlRow("Virtual time", fmt::format("{:.3f} s", report.virtual_s));
  html +=
      htmlRow("Spot frames", fmt::format("{}, {} lost", report.spot.frames.size(), report.spot.frames_lost));
  for (const auto& [name, version] : report.versions) html += htmlRow(name, version, true);
  html += htmlRow("Host", report.host);
  html += htmlRow("Finished", report.finished);
  html += "</tbody></table>";
  if (!report.scenario_text.empty()) {
    html += "<details><summary>The scenario as read</summary><pre>" + escapeHtml(report.scenario_text) +
            "</pre></details>";
  }
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

}  // namespace

std::string htmlReport(const RunReport& report, const Digests& digests) {
  const inspect::InspectionResult& result = report.result;
  std::string page =
      htmlPageHead(fmt::format("{} – {}", inspect::verdictName(result.verdict), report.scenario));
  const std::string facts = htmlFacts({{"Scenario", report.scenario},
                                       {"Firmware", report.firmware},
                                       {"Machine", report.machine},
                                       {"Seed", std::to_string(report.seed)},
                                       {"Imperfections", report.model.imperfections},
                                       {"Model", report.model.twin},
                                       {"Finished", report.finished}});
  page += fmt::format("<header class={}><div class=big>{}</div><p>{}</p><div class=facts>{}</div></header>\n",
                      verdictClass(result.verdict), inspect::verdictName(result.verdict),
                      escapeHtml(verdictSentence(report)), facts);
  page += lostStepsBanner(report);
  if (!result.problems.empty()) {
    std::string list = "<ul class=problems>";
    for (const std::string& problem : result.problems) list += "<li>" + escapeHtml(problem) + "</li>";
    page += htmlSection("Problems of the evidence", list + "</ul>");
  }
  page += htmlSection("Likely causes", diagnosisSection(report));
  if (!result.checks.empty() || !result.unjudged.empty()) page += htmlSection("Checks", checkTable(report));
  page += htmlSection("The cut against the dieline", dielineFigures(report));
  page += htmlSection("Worst places", worstPlaces(report));
  page += htmlSection("Stillness along x, cut by cut", stillnessFigures(report));
  page += htmlSection("Pulse timing", pulseFigures(report));
  if (!result.entities.empty()) page += htmlSection("Entities", entityTable(report));
  page += htmlSection("What the measurement is worth", uncertaintySection(report));
  page += htmlSection("The drawing", drawingFigure(report));
  page += htmlSection("Pictures of the machine", shownPictures(report));
  std::string pictures;
  for (const ReportPicture& picture : report.pictures) {
    pictures += fmt::format("<li><a href='{}'>{}</a> {}</li>", escapeHtml(picture.file),
                            escapeHtml(picture.file), escapeHtml(picture.caption));
  }
  if (!pictures.empty()) page += htmlSection("Files beside this report", "<ul>" + pictures + "</ul>");
  page += htmlSection("Machine", modelSection(report));
  page += htmlSection("What was run", environment(report, digests));
  page += htmlSection("Where the time went", timing(report));
  return page.append(kHtmlPageEnd);
}

}  // namespace kerfbench::report
