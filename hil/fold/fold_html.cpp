// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/fold/fold_report.h"
#include "hil/report/html_text.h"
#include "twin/base/image.h"

namespace kerfbench::fold {
namespace {

using base::escapeHtml;

constexpr double kTimes = 40.0;  // The deviation in the picture.

std::string checksTable(const inspect::SpaceResult& result) {
  std::string rows;
  for (const inspect::Check& check : result.checks) {
    rows += fmt::format(
        "<tr><td>{}</td><td "
        "class=\"{}\">{}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:g}</td><td>{}</td></tr>\n",
        escapeHtml(check.title), report::verdictClass(check.verdict), inspect::verdictName(check.verdict),
        check.value, check.u, check.limit, escapeHtml(check.subject + ". " + check.explanation));
  }
  return "<table><tr><th>check</th><th>verdict</th><th>value, mm</th><th>U (k = "
         "2)</th><th>limit</th><th>where "
         "and why</th></tr>\n" +
         rows + "</table>\n";
}

std::string problemsList(const inspect::SpaceResult& result) {
  std::string items;
  for (const std::string& problem : result.problems)
    items += fmt::format("<li>{}</li>\n", escapeHtml(problem));
  return items.empty() ? "" : "<ul>\n" + items + "</ul>\n";
}

std::string facesTable(const FoldReport& report) {
  std::string rows;
  const inspect::SpaceJob& job = report.scenario.job;
  for (std::size_t i = 0; i < job.faces.size(); ++i) {
    const auto& pose = report.judgement.faces[i].pose;
    if (!pose) continue;
    const Eigen::Isometry3d off = job.faces[i].X_WF.inverse() * pose->X_WF;
    const Eigen::AngleAxisd turn(off.linear());
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.3f}</td><td>{:.4f}</td><td>{:.3f}</td></tr>\n",
                        escapeHtml(job.faces[i].name), pose->marks, pose->rms_px, off.translation().norm(),
                        turn.angle() * 180.0 / std::numbers::pi);
  }
  if (rows.empty()) return "";
  return "<table><tr><th>face</th><th>marks seen</th><th>residual, px</th><th>origin off the drawing, mm</th>"
         "<th>turned from the drawing, deg</th></tr>\n" +
         rows + "</table>\n";
}

/// The picture at a third of its size: enough for people.
std::string thumbnail(const GrayImage& picture) {
  constexpr int kPart = 3;
  GrayImage small(picture.width / kPart, picture.height / kPart);
  for (int row = 0; row < small.height; ++row) {
    for (int column = 0; column < small.width; ++column)
      small.at(column, row) = picture.at(kPart * column, kPart * row);
  }
  return fmt::format(R"(<img alt="survey picture" style="width:48%" src="{}">)", report::pngDataUri(small));
}

}  // namespace

std::string foldHtml(const FoldReport& report) {
  const inspect::SpaceResult& result = report.judgement.result;
  std::string html = report::htmlPageHead(report.scenario.name + ": cut in space");
  html += fmt::format("<h1>{}</h1>\n<p class=\"verdict {}\">{}</p>\n", escapeHtml(report.scenario.name),
                      report::verdictClass(result.verdict), escapeHtml(foldSentence(report)));
  html += report::htmlSection("Evidence that cannot be trusted", problemsList(result));
  html += report::htmlSection(
      "The cut",
      foldPicture(report, kTimes) +
          fmt::format("<p>The contour (line) and the measured edge (dots), whose distance from it is "
                      "drawn {:g} times as large. Green: within half of the limit of {:g} mm; red: "
                      "beyond it. Near folds and corners red is board lost from the piece.</p>",
                      kTimes, report.scenario.limits.path_mm));
  html += report::htmlSection("Checks", checksTable(result));
  html += report::htmlSection("Faces as they stood", facesTable(report));
  std::string pictures;
  for (const GrayImage& picture : report.judgement.survey) {
    if (picture.width > 0) pictures += thumbnail(picture);
  }
  html += report::htmlSection("Survey pictures", pictures);
  html += report::htmlSection("Program", "<pre>" + escapeHtml(report.scenario.program) + "</pre>");
  return html + std::string(report::kHtmlPageEnd);
}

}  // namespace kerfbench::fold
