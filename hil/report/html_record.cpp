// SPDX-License-Identifier: Apache-2.0
// A record to print and to sign: what was judged, by which limits, and with which instruments.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/report/headline.h"
#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"
#include "hil/report/limits.h"

namespace kerfbench::report {
namespace {

std::string limitRows(const RunReport& report) {
  std::string rows;
  for (const NamedLimit& limit : namedLimits(report.limits)) {
    rows += fmt::format("<tr><th scope=row>{}<td>{:g} {}{}</tr>", limit.key, limit.value, limit.unit,
                        limit.value > limit.usual ? fmt::format(" (default {:g})", limit.usual) : "");
  }
  return rows;
}

/// Facts of the run that say what instruments were used: versions with calibrations and pictures among them.
std::string instrumentRows(const RunReport& report) {
  std::string rows;
  for (const auto& [name, value] : report.versions) rows += htmlRow(name, value, true);
  return rows;
}

std::string inputRows(const RunReport& report) {
  std::string rows;
  for (const InputFile& input : report.inputs) rows += htmlRow(input.name, input.sha256, true);
  for (const EvidencePart& part : report.evidence)
    rows += htmlRow("recorded: " + part.name, part.sha256, true);
  return rows;
}

}  // namespace

std::string recordSection(const RunReport& report, const Digests& digests) {
  std::string html = "<div class=record><table><tbody>";
  html += htmlRow("Verdict", std::string(inspect::verdictName(report.result.verdict)));
  html += htmlRow("In words", headlineSentence(report));
  html += htmlRow("With the reservations", reservationsLine(report));
  html += htmlRow("Release", report.firmware);
  html += htmlRow("Machine", report.machine);
  html += htmlRow("Serial number", report.serial_number);
  html += htmlRow("Scenario", report.scenario);
  html += htmlRow("Dieline", report.dieline->path, true);
  html += htmlRow("Digest of the results", digests.results, true);
  html += htmlRow("Digest of the inputs", digests.inputs, true);
  html += "</tbody></table><h3>Release, calibrations and versions</h3><table><tbody>" +
          instrumentRows(report) + "</tbody></table><h3>Limits</h3><table><tbody>" + limitRows(report) +
          "</tbody></table>";
  if (const std::string rows = inputRows(report); !rows.empty())
    html += "<h3>Files, by SHA-256</h3><table><tbody>" + rows + "</tbody></table>";
  html += "<div class=sign>";
  for (const char* line : {"Operator, name", "Date", "Signature", "Released by, name", "Date", "Signature"})
    html += fmt::format("<div>{}</div>", line);
  return html + "</div></div>";
}

}  // namespace kerfbench::report
