// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/fold/fold_scenario.h"
#include "hil/fold/judge/fold_judge.h"

namespace kerfbench::fold {

/// Everything that the files of a results folder tell.
struct FoldReport {
  const FoldScenario& scenario;
  const FoldJudgement& judgement;
  double missed_mm{};        ///< Way of the beam that met no face; of the model, judged by nothing.
  std::string command_line;  ///< As typed.
};

/// fold.json: verdict, checks, poses of the faces, every reading. With a digest of what was measured and
/// judged, equal from run to run.
std::string foldJson(const FoldReport& report);
/// junit.xml: one case for each check, and one for the evidence.
std::string foldJunit(const FoldReport& report);
/// report.html: one page that needs no other file.
std::string foldHtml(const FoldReport& report);
/// The blank in parallel projection with contour and measured edge, whose deviation is drawn `times` as
/// large; an SVG element.
std::string foldPicture(const FoldReport& report, double times);

/// "PASS: …" and the reason in one sentence.
std::string foldSentence(const FoldReport& report);

}  // namespace kerfbench::fold
