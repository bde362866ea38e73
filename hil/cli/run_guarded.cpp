// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/run_guarded.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/exit_codes.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "hil/run/release.h"
#include "twin/machine/divergence.h"

namespace kerfbench::cli {

int runGuarded(const std::filesystem::path& scenario, const std::function<int()>& work) {
  try {
    return work();
  } catch (const base::ConfigError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const dieline::DielineError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const planner::PlanError& e) {
    std::fputs(fmt::format("the job cannot be planned: {}\n", e.what()).c_str(), stderr);
  } catch (const twin::DivergenceError& e) {
    std::fputs(fmt::format("{}: {}; no verdict\n", scenario.string(), e.what()).c_str(), stderr);
    return base::kExitBroken;
  } catch (const base::InputError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  }
  return base::kExitInput;
}

}  // namespace kerfbench::cli
