// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/controller/pulse_counter.h"
#include "hil/controller/uart_listener.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/inspect/verdict/controller_end.h"

namespace kerfbench::controller {

/// Controller's own words on the run, as in Evidence.
struct ControllerReport {
  std::optional<inspect::ControllerAccount> account;
  std::optional<inspect::ControllerEnd> end;
};

/// End of the run as the controller reported it, and who is responsible. The release's is all but a line or a
/// host that failed, a guard that was opened (by the sensors of `recording`), and faults that this bench does
/// not know.
inspect::ControllerEnd controllerEnd(const UartListener& ear, const PulseCounter& pins,
                                     const source::PinRecording& recording);

/// A dialog with the controller that failed.
struct DialogFailure {
  std::string reason;  ///< Empty: it did not fail. Else "at 1.234 s: …".
  double time_s{};     ///< The dialog had received what the recording's UART holds up to here, and no more.
};

/// Reason why the end proves nothing; empty where it proves something. A dialog that failed is no problem if
/// it did so because the controller stopped. `is_sound`: nothing else was wrong with the run.
std::string unprovenEnd(const inspect::ControllerEnd& end, const DialogFailure& dialog, bool is_sound);

}  // namespace kerfbench::controller
