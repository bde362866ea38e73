// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "hil/base/console.h"
#include "hil/batch/stop_signals.h"
#include "hil/campaign/identity.h"
#include "hil/campaign/slurm.h"

namespace kerfbench::app {

/// An array for Slurm, and how it is watched.
struct SlurmOrder {
  campaign::SlurmArray array;
  std::size_t runs{};  ///< Runs of the whole campaign.
  double poll_s{5.0};  ///< Between two looks at the queue.
};

/// Writes the script of the array into the campaign's folder. If it is to be submitted: gives it to sbatch,
/// unless an array of this folder is in the queue already, and waits until it has left the queue. A signal
/// ends the waiting, not the array. Returns 0, or base::kExitWaiting after a signal.
/// @throws base::InputError if Slurm is not there, or refuses the array.
int handToSlurm(const SlurmOrder& order, const campaign::Prepared& prepared, bool submit,
                batch::StopSignals& signals, base::Console& console);

}  // namespace kerfbench::app
