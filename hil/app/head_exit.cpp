// SPDX-License-Identifier: Apache-2.0
#include "hil/app/head_exit.h"

#include <fmt/format.h>

#include <cstdio>

#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/app/exit_codes.h"
#include "hil/app/sheet_by_hand.h"

namespace kerfbench::hil {

int guardedHead(const std::filesystem::path& machine, const std::string& so,
                const std::function<int()>& work) {
  constexpr int kExitInvalid = 3;
  const auto invalid = [&](const char* why) {
    std::fputs(fmt::format("{}\nINVALID: {}\n", why, so).c_str(), stderr);
    return kExitInvalid;
  };
  try {
    return guarded(machine, work);
  } catch (const HeadEvidenceError& error) {
    return invalid(error.what());
  } catch (const HeadCalibrationError& error) {
    return invalid(error.what());
  } catch (const SheetWanted& wanted) {
    Console(true).result(wanted.what());
    return kExitWaiting;
  }
}

}  // namespace kerfbench::hil
