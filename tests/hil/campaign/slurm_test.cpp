// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/slurm.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;

SlurmArray plainArray() {
  return {.name = "speeds",
          .shards = 7,
          .cpus = 2,
          .program = "/opt/k b/kerfbench",
          .campaign = "/home/q/it's.yaml",
          .folder = "/scratch/out",
          .keep = "bad",
          .options = {"--partition=night", "--time=01:00:00"}};
}

TEST(Slurm, TheScriptIsAnArrayThatIsQueuedAgainWhenItsNodeFails) {
  const std::string script = arrayScript(plainArray());
  EXPECT_TRUE(script.starts_with("#!/bin/sh\n"));
  for (const char* line : {"#SBATCH --array=1-7\n", "#SBATCH --requeue\n", "#SBATCH --open-mode=append\n",
                           "#SBATCH --cpus-per-task=2\n", "#SBATCH --partition=night\n",
                           "#SBATCH --time=01:00:00\n", "#SBATCH --output=/scratch/out/slurm/%A_%a.log\n"})
    EXPECT_THAT(script, HasSubstr(line));
  EXPECT_THAT(script,
              HasSubstr("exec '/opt/k b/kerfbench' campaign '/home/q/it'\\''s.yaml' --output '/scratch/out' "
                        "--shard \"$SLURM_ARRAY_TASK_ID/7\" --jobs 2 --keep bad\n"));
  // sbatch reads its options up to the first command.
  EXPECT_LT(script.rfind("#SBATCH"), script.find("exec"));
}

TEST(Slurm, AnOptionCannotBecomeACommand) {
  SlurmArray array = plainArray();
  array.options = {"--partition=night\nrm -rf /"};
  EXPECT_THROW((void)arrayScript(array), std::invalid_argument);
  array.options = {"partition=night"};
  EXPECT_THROW((void)arrayScript(array), std::invalid_argument);
}

TEST(Slurm, TheNumberOfAJobIsFoundAmongWarnings) {
  EXPECT_EQ(jobNumberIn("4711\n"), "4711");
  EXPECT_EQ(jobNumberIn("sbatch: warning: 2 nodes\n4711;cluster\n"), "4711");
  EXPECT_FALSE(jobNumberIn("sbatch: error: Batch job submission failed\n"));
  EXPECT_FALSE(jobNumberIn(""));
}

TEST(Slurm, AnArrayIsOverWhenTheQueueForgetsIt) {
  const QueueState running = queueStateIn(0, "RUNNING\nPENDING\nRUNNING\n");
  EXPECT_FALSE(running.is_over);
  EXPECT_EQ(queueWords(running), "1 PENDING, 2 RUNNING");
  EXPECT_TRUE(queueStateIn(0, "").is_over);
  EXPECT_TRUE(queueStateIn(1, "slurm_load_jobs error: Invalid job id specified\n").is_over);
  // A controller that does not answer says nothing about the array.
  const QueueState mute = queueStateIn(1, "slurm_load_jobs error: Unable to contact slurm controller\n");
  EXPECT_FALSE(mute.is_over);
  EXPECT_THAT(mute.trouble, HasSubstr("Unable to contact"));
  EXPECT_FALSE(queueStateIn(127, "").is_over);
}

TEST(Slurm, AToolThatIsNotThereIsToldByItsExitCode) {
  const base::TempFolder folder;
  EXPECT_EQ(runTool({"kerfbench-no-such-tool"}, folder.path()).exit_code, 127);
  const ToolOutput echo = runTool({"echo", "a b"}, folder.path());
  EXPECT_EQ(echo.exit_code, 0);
  EXPECT_EQ(echo.output, "a b\n");
  EXPECT_EQ(runTool({"echo", "again"}, folder.path()).output, "again\n");
}

}  // namespace
}  // namespace kerfbench::campaign
