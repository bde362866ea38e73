// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/head_exit.h"

#include <fmt/format.h>

#include <cstdio>

#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/terminal.h"
#include "hil/cli/run_guarded.h"
#include "hil/head_service/sheet_by_hand.h"

namespace kerfbench::instrument {

int guardedHead(const std::filesystem::path& machine, const std::string& so,
                const std::function<int()>& work) {
  constexpr int kExitInvalid = 3;
  const auto invalid = [&](const char* why) {
    base::toTerminal(stderr, fmt::format("{}\nINVALID: {}\n", why, so));
    return kExitInvalid;
  };
  try {
    return cli::runGuarded(machine, work);
  } catch (const head_service::HeadEvidenceError& error) {
    return invalid(error.what());
  } catch (const calibrate::HeadCalibrationError& error) {
    return invalid(error.what());
  } catch (const head_service::SheetWanted& wanted) {
    base::Console(true).result(wanted.what());
    return base::kExitWaiting;
  }
}

}  // namespace kerfbench::instrument
