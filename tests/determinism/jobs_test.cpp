// SPDX-License-Identifier: Apache-2.0
// The number of threads changes nothing that is measured or judged.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/judge/judge.h"
#include "hil/report/run_report.h"
#include "hil/run/dialogs.h"
#include "hil/run/lockstep.h"
#include "hil/run/release.h"
#include "hil/scenario/case.h"

namespace kerfbench::determinism {
namespace {

namespace fs = std::filesystem;

/// A label on the fast twin with all its imperfections, run once and played again for each judgement.
class LabelRun {
 public:
  LabelRun() : case_(readLabel()), machine_(scenario::sampledMachine(case_).machine) {
    run::PreparedJob job = run::prepareJob(case_);
    const auto source = run::openRelease(case_.scenario.firmware, fs::path(KERFBENCH_BINARY_DIR) / "bin");
    rate_ = source->info().rate;
    twin::Twin twin = newTwin();
    run_ = run::runLockstep(*source, twin, machine_.signals, job.dialog.get(), {}, {});
  }

  [[nodiscard]] const std::vector<std::string>& problems() const { return run_.problems; }
  [[nodiscard]] report::RunReport judged(int jobs) const {
    twin::Twin twin = newTwin();
    twin.advance(run_.recording.end, run_.recording.outputs);
    base::Stopwatch stopwatch;
    report::RunReport report;
    judge::judge(
        case_, twin, {}, {}, {}, jobs, stopwatch, [](double, const std::string&) {}, report);
    return report;
  }

 private:
  static scenario::Case readLabel() {
    scenario::Case label =
        scenario::readCase(fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/scenarios/native/label-on-belt.yaml",
                           fs::path(KERFBENCH_BINARY_DIR) / "firmware");
    label.scenario.fidelity = twin::Fidelity::kFast;
    label.scenario.imperfections = twin::Preset::kDynamic;
    return label;
  }
  [[nodiscard]] twin::Twin newTwin() const {
    return {machine_,
            scenario::webOf(case_),
            rate_,
            {.fidelity = case_.scenario.fidelity, .seed = case_.scenario.seed}};
  }

  scenario::Case case_;
  twin::MachineDescription machine_;
  TickRate rate_;
  run::LockstepResult run_;
};

TEST(Jobs, OneTwoAndSevenThreadsMeasureAndJudgeTheSame) {
  const LabelRun label;
  ASSERT_TRUE(label.problems().empty()) << label.problems().front();
  const report::RunReport one = label.judged(1);
  ASSERT_FALSE(one.result.checks.empty());
  for (const int jobs : {2, 7}) {
    const report::RunReport many = label.judged(jobs);
    EXPECT_EQ(report::digestOf(many), report::digestOf(one)) << jobs << " threads";
  }
}

}  // namespace
}  // namespace kerfbench::determinism
