// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_run.h"

#include <system_error>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/fold/fold_report.h"
#include "hil/fold/fold_scenario.h"
#include "hil/fold/fold_twin.h"
#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::fold {
namespace {

std::string checkLine(const inspect::Check& check) {
  return fmt::format("  {:<15} {:<10} {:8.4f} mm  U {:.4f}  limit {:g}{}", check.name,
                     inspect::verdictName(check.verdict), check.value, check.u, check.limit,
                     check.subject.empty() ? "" : "  " + check.subject);
}

}  // namespace

int runFold(const std::filesystem::path& scenario, const std::filesystem::path& out,
            const FoldOptions& options) {
  base::Console console(options.quiet);
  const FoldScenario read = readFoldScenario(scenario);
  // A verdict of an earlier run must not stand beside files of this one.
  std::filesystem::create_directories(out);
  std::filesystem::remove(out / "fold.json");
  const twin::FoldedCut cut = cutOnTwin(read);
  TwinFoldCameras cameras(read, cut, options.jobs);
  const FoldInstruments instruments = instrumentsOf(read, options.jobs);
  const FoldJudgement judgement =
      judgeFold(read.job, read.contour, instruments, read.limits, cameras, read.seed);
  const FoldReport report{read, judgement, cut.missed_mm, options.command_line};
  base::writeFileAtomically(out / "program.gcode", read.program);
  base::writeFileAtomically(out / "junit.xml", foldJunit(report));
  base::writeFileAtomically(out / "report.html", foldHtml(report));
  base::writeFileAtomically(out / "fold.json", foldJson(report));
  for (const std::string& problem : judgement.result.problems) console.say("  " + problem);
  for (const inspect::Check& check : judgement.result.checks) console.say(checkLine(check));
  console.result(fmt::format("{}: {}", read.name, foldSentence(report)));
  return inspect::exitCode(judgement.result.verdict);
}

}  // namespace kerfbench::fold
