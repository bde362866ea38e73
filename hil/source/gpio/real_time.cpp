// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/real_time.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace kerfbench::source {

RealTime::RealTime(std::shared_ptr<GpioSystem> system) : system_(std::move(system)) {
  const KernelAnswer priority = system_->setRealTime(kPriority);
  if (priority.failed()) {
    notes_.push_back(
        fmt::format("no real-time priority ({}): other programs can make the bench late, and edges are lost "
                    "sooner; allow it with '@gpio - rtprio {}' in /etc/security/limits.d/kerfbench.conf",
                    std::generic_category().message(priority.error), kPriority));
  }
  const KernelAnswer locked = system_->lockMemory();
  if (locked.failed()) {
    notes_.push_back(
        fmt::format("memory is not locked ({}): a page from the disk can make the bench late; allow it with "
                    "'@gpio - memlock "
                    "unlimited' in /etc/security/limits.d/kerfbench.conf",
                    std::generic_category().message(locked.error)));
  }
}

}  // namespace kerfbench::source
