// SPDX-License-Identifier: Apache-2.0
// The number of threads changes nothing that is measured or judged.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/judge/judge.h"
#include "hil/judge/kerf_watch.h"
#include "hil/judge/spot_watch.h"
#include "hil/report/run_report.h"
#include "hil/run/dialogs.h"
#include "hil/run/model_machine.h"
#include "hil/run/release.h"
#include "hil/scenario/case.h"
#include "hil/source/open.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::determinism {
namespace {

namespace fs = std::filesystem;

/// A label on the fast twin with all its imperfections, run once and played again for each judgement.
class LabelRun {
 public:
  LabelRun() : case_(readLabel()), sampled_(scenario::sampledMachine(case_)) {
    run::PreparedJob job = run::prepareJob(case_);
    const auto source = run::openRelease(case_.scenario.firmware, fs::path(KERFBENCH_BINARY_DIR) / "bin");
    run::ModelMachine machine(case_, sampled_, source->info().rate, run::modelOptions(case_));
    run_ = machine.run(*source, job.dialog.get(), {}, {});
  }

  [[nodiscard]] const std::vector<std::string>& problems() const { return run_.problems; }
  [[nodiscard]] report::RunReport judged(int jobs) const {
    run::ModelMachine machine(case_, sampled_, run_.recording.rate, run::modelOptions(case_));
    const auto watch = judge::SpotWatch::of(case_, machine, run_.recording.rate, jobs);
    EXPECT_EQ(watch != nullptr, jobs > 1);
    const auto kerf_watch = judge::KerfWatch::of(case_, machine, jobs);
    EXPECT_TRUE(kerf_watch);
    run::LockstepOptions lockstep;
    lockstep.heard = judge::heardBy(watch.get());
    machine.run(*source::openRecording(run_.recording, "label"), nullptr, lockstep, {});
    base::Stopwatch stopwatch;
    report::RunReport report;
    judge::addJudgement(judge::judge(case_, run_, {}, {machine, {}, jobs, watch.get(), kerf_watch.get()},
                                     {stopwatch, [](double, const std::string&) {}}),
                        report);
    return report;
  }

  /// Spot and cut are watched, and nobody asks for what was seen.
  void leftAfterRun() const {
    run::ModelMachine machine(case_, sampled_, run_.recording.rate, run::modelOptions(case_));
    const auto watch = judge::SpotWatch::of(case_, machine, run_.recording.rate, 2);
    ASSERT_TRUE(watch);
    ASSERT_TRUE(judge::KerfWatch::of(case_, machine, 2));
    watch->heard(run_.recording.end, std::vector<PinEvent>{run_.recording.outputs.front()});
  }

 private:
  static scenario::Case readLabel() {
    const base::TempFolder folder;
    const fs::path one = folder.write(
        "one.yaml", "extends: '" + base::fixture("scenarios/native/label-on-belt.yaml").string() +
                        "'\nprint: {units: 1}\n");
    scenario::Case label = scenario::readCase(one, fs::path(KERFBENCH_BINARY_DIR) / "firmware");
    label.scenario.fidelity = twin::Fidelity::kFast;
    label.scenario.imperfections = twin::Preset::kDynamic;
    return label;
  }

  scenario::Case case_;
  twin::SampledMachine sampled_;
  run::RecordedRun run_;
};

TEST(Jobs, ARunThatEndsWithoutAVerdictWaitsForNobody) {
  const LabelRun label;
  label.leftAfterRun();
}

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
