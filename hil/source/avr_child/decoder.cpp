// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/decoder.h"

#include <array>

namespace kerfbench::avr_child {
namespace {

/// LDS, STS, JMP and CALL.
constexpr std::array<emulator::Pattern, 4> kTwoWords{"1001 000d dddd 0000", "1001 001d dddd 0000",
                                                     "1001 010k kkkk 110k", "1001 010k kkkk 111k"};

bool buildFrom(std::span<const EncodingRow> rows, const Encoding& e, unsigned bits, Operation& op) {
  for (const EncodingRow& row : rows) {
    if (!row.pattern.matches(e.code, bits)) continue;
    return row.build(Encoding{row.pattern, e.code, e.pc, e.processor}, op);
  }
  return false;
}

bool build(const Processor& p, std::uint32_t pc, Operation& op) {
  static constexpr emulator::Pattern kNone = "";
  if (pc + 2 > p.flash_bytes) return false;
  std::uint32_t code = p.wordAt(pc);
  const unsigned words = wordsOf(code);
  if (pc + 2 * words > p.flash_bytes) return false;
  if (words == 2) code = code << 16U | p.wordAt(pc + 2);
  const Encoding e{kNone, code, pc, p};
  for (const auto rows : {arithmeticRows(), bitRows(), registerAccessRows(), accessRows(), branchRows()}) {
    Operation built;
    if (!buildFrom(rows, e, 16 * words, built)) continue;
    op = built;
    return true;
  }
  return false;
}

}  // namespace

unsigned wordsOf(std::uint32_t first) {
  for (const emulator::Pattern& pattern : kTwoWords) {
    if (pattern.matches(first, 16)) return 2;
  }
  return 1;
}

unsigned wordsBehind(const Encoding& e) {
  return e.pc + 4 > e.processor.flash_bytes ? 1 : wordsOf(e.processor.wordAt(e.pc + 2));
}

void decodeFirst(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (!build(p, p.pcOf(at), *at)) at->execute = &elsewhere;
  KERFBENCH_TAIL return at->execute(p, at, now, data);
}

}  // namespace kerfbench::avr_child
