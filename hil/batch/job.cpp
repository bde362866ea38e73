// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/job.h"

#include <cstring>

#include <fmt/format.h>

namespace kerfbench::batch {

std::string describe(const JobEnd& end) {
  switch (end.how) {
    case JobEnd::How::kExited:
      return fmt::format("ended with exit code {}", end.code);
    case JobEnd::How::kSignal:
      return fmt::format("was ended by signal {} ({})", end.code, ::strsignal(end.code));
    case JobEnd::How::kNotStarted:
      break;
  }
  return fmt::format("could not be started: {}", std::strerror(end.code));
}

}  // namespace kerfbench::batch
