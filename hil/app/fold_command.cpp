// SPDX-License-Identifier: Apache-2.0
#include "hil/app/fold_command.h"

#include <filesystem>

#include "hil/base/exit_codes.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::app {

int foldCommand(const fold::FoldOptions& options) {
  int code = 0;
  for (const std::filesystem::path& scenario : options.scenarios) {
    const std::filesystem::path out =
        options.scenarios.size() == 1 ? options.out : options.out / scenario.stem();
    code = base::worstExitCode(
        code, cli::runGuarded(scenario, [&] { return fold::runFold(scenario, out, options); }));
  }
  return code;
}

}  // namespace kerfbench::app
