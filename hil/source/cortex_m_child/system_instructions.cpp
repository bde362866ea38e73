// SPDX-License-Identifier: Apache-2.0
// Instructions of the system: those that ExceptionUnit::executeTrap() carries out, barriers, hints (ARMv7-M
// 2010, A5.2.5, A5.3.4).
#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

Stop trap(Processor& p, Operation* at, Cycle now) { return p.stopAt(at, now, Stop::kTrap); }

/// Hints without effect, and barriers: memory is as the program has left it at any time.
Stop nothing(Processor& p, Operation* at, Cycle now) { KERFBENCH_TAIL return next(p, at, now); }

Stop clearExclusive(Processor& p, Operation* at, Cycle now) {
  p.exclusive = false;
  KERFBENCH_TAIL return next(p, at, now);
}

template <Handler kHandler>
bool buildPlain(const Encoding& /*e*/, Operation& op) {
  op.execute = kHandler;
  return true;
}

/// WFE, WFI and SEV.
bool buildHint(const Encoding& e, Operation& op) {
  const std::uint32_t hint = e['h'];
  op.execute = hint >= 2 && hint <= 4 ? &trap : &nothing;
  return true;
}

bool buildChangeState(const Encoding& e, Operation& op) {
  op.execute = &trap;
  return !e.in_if_then && e['f'] != 0;
}

/// The special registers that ARMv7-M has, by SYSm.
bool isSpecial(std::uint32_t number) {
  return number <= 3 || (number >= 5 && number <= 9) || (number >= 16 && number <= 20);
}

bool buildSpecial(const Encoding& e, Operation& op) {
  op.execute = &trap;
  return isSpecial(e['y']) && !isSpOrPc(e['d']);
}

bool refuse(const Encoding& /*e*/, Operation& /*op*/) { return false; }

constexpr EncodingRow kRows[] = {
    {"10111111 hhhh 0000", buildHint},
    {"10110110 011 i 00 ff", buildChangeState},
    {"10111110 iiiiiiii", buildPlain<trap>},
    {"11011110 iiiiiiii", refuse},
    {"11011111 iiiiiiii", buildPlain<trap>},
    {"11110011 1010 1111 1000 0000 hhhhhhhh", buildHint},
    {"11110011 1000 dddd 1000 mm 00 yyyyyyyy", buildSpecial},
    {"11110011 1110 1111 1000 dddd yyyyyyyy", buildSpecial},
    {"11110011 1011 1111 1000 1111 0010 1111", buildPlain<clearExclusive>},
    {"11110011 1011 1111 1000 1111 0100 iiii", buildPlain<nothing>},
    {"11110011 1011 1111 1000 1111 0101 iiii", buildPlain<nothing>},
    {"11110011 1011 1111 1000 1111 0110 iiii", buildPlain<nothing>},
};

}  // namespace

std::span<const EncodingRow> systemRows() { return kRows; }

}  // namespace kerfbench::cortex_m_child
