// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/gpio/jumper_kernel.h"

#include <algorithm>
#include <cerrno>

namespace kerfbench::source {

KernelAnswer JumperKernel::control(int fd, unsigned long request_code, void* argument) {
  const std::uint64_t called_ns = now_;
  if (request_code == GPIO_V2_LINE_SET_VALUES_IOCTL && edges_ == vanishes_at) return {-1, ENODEV};
  const KernelAnswer answer = ScriptedKernel::control(fd, request_code, argument);
  if (answer.failed()) return answer;
  if (request_code == GPIO_V2_GET_LINE_IOCTL) {
    const auto* wanted = static_cast<const gpio_v2_line_request*>(argument);
    if ((wanted->config.flags & GPIO_V2_LINE_FLAG_INPUT) != 0) {
      forgetEdges();
      edges_ = 0;
      seqno_ = 0;
      line_seqno_ = {};
    }
  }
  if (request_code == GPIO_V2_LINE_SET_VALUES_IOCTL)
    follow((static_cast<const gpio_v2_line_values*>(argument)->bits & 1U) != 0, called_ns);
  return answer;
}

void JumperKernel::follow(bool level, std::uint64_t called_ns) {
  const bool seen = stuck_high || (plugged && level != inverts);
  level_bits = seen ? 1 : 0;
  if (seen == level_) return;
  level_ = seen;
  const std::uint64_t edge = edges_++;
  if (silent) return;
  // The sum wraps as it should.
  const std::uint64_t stamp_ns = called_ns + latency_ns + static_cast<std::uint64_t>(clock_offset_ns);
  if (merged.contains(edge)) {
    ++seqno_;
    return;
  }
  tell(stamp_ns, 0, seen);
  if (bounces.contains(edge)) {
    tell(stamp_ns + 1, 0, !seen);
    tell(stamp_ns + 2, 0, seen);
  }
  if (edge == 0) {
    for (std::uint64_t i = 0; i < beside; ++i) tell(stamp_ns + 10 + i, 1, i % 2 == 0);
  }
}

void JumperKernel::tell(std::uint64_t stamp_ns, std::size_t line, bool level) {
  edge(stamp_ns, request.offsets[line], level, ++seqno_, ++line_seqno_.at(line), std::max(stamp_ns, now_));
}

}  // namespace kerfbench::source
