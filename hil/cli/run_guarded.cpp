// SPDX-License-Identifier: Apache-2.0
#include "hil/cli/run_guarded.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/exit_codes.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "hil/run/release.h"
#include "twin/machine/divergence.h"

namespace kerfbench::cli {

int runGuarded(const std::filesystem::path& scenario, const std::function<int()>& work) {
  try {
    return work();
  } catch (const base::ConfigError& e) {
    base::toTerminal(stderr, fmt::format("{}\n", e.what()));
  } catch (const dieline::DielineError& e) {
    base::toTerminal(stderr, fmt::format("{}\n", e.what()));
  } catch (const planner::PlanError& e) {
    base::toTerminal(stderr, fmt::format("the job cannot be planned: {}\n", e.what()));
  } catch (const twin::DivergenceError& e) {
    base::toTerminal(stderr, fmt::format("{}: {}; no verdict\n", scenario.string(), e.what()));
    return base::kExitBroken;
  } catch (const base::InputError& e) {
    base::toTerminal(stderr, fmt::format("{}\n", e.what()));
  }
  return base::kExitInput;
}

}  // namespace kerfbench::cli
