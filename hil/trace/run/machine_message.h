// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/scenario/case.h"
#include "hil/trace/run/known_program.h"
#include "hil/trace/run/wired_signals.h"
#include "twin/base/pin_event.h"
#include "twin/description/imperfections.h"

namespace kerfbench::trace {

/// What /machine tells of a run.
struct MachineFacts {
  const scenario::Case& test_case;
  const twin::MachineDescription& machine;  ///< The one that runs.
  const WiredSignals& signals;
  TickRate rate;
  double quantum_s{};
  const KnownProgram& program;
};
/// The message.
std::string machineMessage(const MachineFacts& facts);

}  // namespace kerfbench::trace
