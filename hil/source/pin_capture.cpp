// SPDX-License-Identifier: Apache-2.0
#include "hil/source/pin_capture.h"

#include <fmt/format.h>

namespace kerfbench::hil {

std::string highAtStartWords(const std::string& signal) {
  return signal +
         " is high at the start, and its drive counts rising edges: polarity or wiring is not as the machine "
         "file has it";
}

std::string timeLimitWords(double time_limit_s, bool any_edge) {
  return any_edge
             ? fmt::format("the time limit of {} s was reached, and the pins were not quiet", time_limit_s)
             : fmt::format("no edge came within {} s: is the controller wired, powered and started?",
                           time_limit_s);
}

}  // namespace kerfbench::hil
