// SPDX-License-Identifier: Apache-2.0
#include "hil/app/suite_command.h"

#include "hil/base/console.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::app {

int suiteCommand(const suite::SuiteOptions& options) {
  return cli::runGuarded(options.plan, [&] {
    base::Console console(options.quiet);
    return suite::runSuite(options, console);
  });
}

}  // namespace kerfbench::app
