// SPDX-License-Identifier: Apache-2.0
// kerfplan-scenario: kerfplan, with values of scenario and machine files as the defaults of its options.
// kerfplan hands over to it, because the planner itself knows nothing of the bench (decision 090).
#include <filesystem>

#include "firmware_under_test/planner/kerfplan/kerfplan.h"
#include "hil/planned_case/read_planned_case.h"

int main(int argc, char** argv) {
  using namespace kerfbench;
  return planner::kerfplanMain(
      argc, argv, [](const planner::CaseFiles& files, const planner::JobParameters& job) {
        const auto bin_dir = std::filesystem::read_symlink("/proc/self/exe").parent_path();
        return planned_case::readPlannedCase(files, job, bin_dir);
      });
}
