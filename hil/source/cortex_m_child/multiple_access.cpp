// SPDX-License-Identifier: Apache-2.0
// Loads and stores of several registers, of two, and exclusive ones (ARMv7-M 2010, A4.6.5, A5.3.5, A5.3.6).
// Words that these access must be aligned.
#include <bit>
#include <cstring>

#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

/// Bits of Operation::kind.
constexpr std::uint8_t kDown = 1, kWritesBack = 2;

/// What is accessed by LDM, STM, PUSH or POP; bytes in `shift`.
void setList(Operation& op, std::uint32_t registers) {
  op.number = registers;
  op.shift = static_cast<std::uint8_t>(4 * std::popcount(registers));
}

bool isWithinSram(const Processor& p, std::uint32_t address, unsigned bytes) {
  const std::uint32_t offset = address - kSramBase;
  return (address & 3U) == 0 && offset < p.sram_bytes && p.sram_bytes - offset >= bytes;
}

std::uint32_t firstAddress(const Processor& p, const Operation* at, unsigned bytes) {
  return (at->kind & kDown) != 0 ? p.r[at->n] - bytes : p.r[at->n];
}

bool readWords(Processor& p, const Operation* at, std::uint32_t address, unsigned bytes,
               std::uint32_t* words) {
  if (isWithinSram(p, address, bytes)) {
    const std::uint8_t* const from = p.sram + (address - kSramBase);
    for (unsigned done = 0; done < bytes; done += 4) std::memcpy(&words[done / 4], from + done, 4);
    return true;
  }
  for (unsigned done = 0; done < bytes; done += 4) {
    const auto word = p.readWord(at, address + done);
    if (!word) return false;
    words[done / 4] = *word;
  }
  return true;
}

bool writeWords(Processor& p, const Operation* at, std::uint32_t address, unsigned bytes,
                const std::uint32_t* words) {
  p.has_effect = true;
  if (isWithinSram(p, address, bytes)) {
    std::uint8_t* const to = p.sram + (address - kSramBase);
    for (unsigned done = 0; done < bytes; done += 4) std::memcpy(to + done, &words[done / 4], 4);
    p.forgetCode(address, bytes);
    return true;
  }
  for (unsigned done = 0; done < bytes; done += 4) {
    if (!p.writeWord(at, address + done, words[done / 4])) return false;
  }
  return true;
}

void writeBack(Processor& p, const Operation* at, unsigned bytes) {
  if ((at->kind & kWritesBack) == 0) return;
  p.r[at->n] += (at->kind & kDown) != 0 ? 0U - bytes : bytes;
}

/// LDM and POP have loaded all registers but the PC, whose word this is.
[[gnu::always_inline]] inline Stop goOn(Processor& p, Operation* at, Cycle now) {
  if ((at->number & 0x8000U) == 0) KERFBENCH_TAIL return next(p, at, now);
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

Stop loadSeveralElsewhere(Processor& p, Operation* at, Cycle now) {
  std::uint32_t words[16];
  p.present.cycle = now;
  const bool is_done = readWords(p, at, firstAddress(p, at, at->shift), at->shift, words);
  now = p.present.cycle;
  if (!is_done) return p.stopAt(at, now, p.failure);
  writeBack(p, at, at->shift);
  const std::uint32_t* word = words;
  for (std::uint32_t left = at->number & 0x7FFFU; left != 0; left &= left - 1)
    p.r[static_cast<unsigned>(std::countr_zero(left))] = *word++;
  if ((at->number & 0x8000U) != 0) p.pc = *word;
  KERFBENCH_TAIL return goOn(p, at, now);
}

/// LDM and POP.
Stop loadSeveral(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t first = firstAddress(p, at, at->shift);
  if (!isWithinSram(p, first, at->shift)) [[unlikely]]
    KERFBENCH_TAIL return loadSeveralElsewhere(p, at, now);
  const std::uint8_t* from = p.sram + (first - kSramBase);
  writeBack(p, at, at->shift);
  for (std::uint32_t left = at->number & 0x7FFFU; left != 0; left &= left - 1, from += 4)
    std::memcpy(&p.r[static_cast<unsigned>(std::countr_zero(left))], from, 4);
  if ((at->number & 0x8000U) != 0) std::memcpy(&p.pc, from, 4);
  KERFBENCH_TAIL return goOn(p, at, now);
}

Stop storeSeveralElsewhere(Processor& p, Operation* at, Cycle now) {
  std::uint32_t words[16];
  std::uint32_t* word = words;
  for (std::uint32_t left = at->number; left != 0; left &= left - 1)
    *word++ = p.r[static_cast<unsigned>(std::countr_zero(left))];
  p.present.cycle = now;
  const bool is_done = writeWords(p, at, firstAddress(p, at, at->shift), at->shift, words);
  now = p.present.cycle;
  if (!is_done) return p.stopAt(at, now, p.failure);
  writeBack(p, at, at->shift);
  KERFBENCH_TAIL return next(p, at, now);
}

/// STM and PUSH.
Stop storeSeveral(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t first = firstAddress(p, at, at->shift);
  if (!isWithinSram(p, first, at->shift) || p.sram_code_bytes != 0) [[unlikely]]
    KERFBENCH_TAIL return storeSeveralElsewhere(p, at, now);
  std::uint8_t* to = p.sram + (first - kSramBase);
  for (std::uint32_t left = at->number; left != 0; left &= left - 1, to += 4)
    std::memcpy(to, &p.r[static_cast<unsigned>(std::countr_zero(left))], 4);
  p.has_effect = true;
  writeBack(p, at, at->shift);
  KERFBENCH_TAIL return next(p, at, now);
}

/// LDRD and STRD: `kind` is 0 where the base gets no sum, 1 where it gets it before, 2 after. Rt2 is in `m`.
struct Dual {
  std::uint32_t address{};
  std::uint32_t sum{};
};

Dual dualOf(const Processor& p, const Operation* at) {
  const std::uint32_t base = at->n == kPc ? (at->pc + 4) & ~3U : p.r[at->n];
  const std::uint32_t sum = base + at->number;
  return {at->kind == 2 ? base : sum, sum};
}

Stop loadDual(Processor& p, Operation* at, Cycle now) {
  if (at->n == kPc) now += p.wait_states;
  const Dual dual = dualOf(p, at);
  std::uint32_t words[2];
  p.present.cycle = now;
  const bool is_done = readWords(p, at, dual.address, 8, words);
  now = p.present.cycle;
  if (!is_done) return p.stopAt(at, now, p.failure);
  if (at->kind != 0) p.r[at->n] = dual.sum;
  p.r[at->d] = words[0];
  p.r[at->m] = words[1];
  KERFBENCH_TAIL return next(p, at, now);
}

Stop storeDual(Processor& p, Operation* at, Cycle now) {
  const Dual dual = dualOf(p, at);
  const std::uint32_t words[2] = {p.r[at->d], p.r[at->m]};
  p.present.cycle = now;
  const bool is_done = writeWords(p, at, dual.address, 8, words);
  now = p.present.cycle;
  if (!is_done) return p.stopAt(at, now, p.failure);
  if (at->kind != 0) p.r[at->n] = dual.sum;
  KERFBENCH_TAIL return next(p, at, now);
}

/// LDREX of `kind` bytes.
Stop loadExclusive(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t address = p.r[at->n] + at->number;
  if ((address & (at->kind - 1U)) != 0) {
    p.fault_address = address;
    return p.stopAt(at, now, Stop::kUnaligned);
  }
  p.present.cycle = now;
  const auto value = p.readElsewhere(at, address, at->kind);
  now = p.present.cycle;
  if (!value) return p.stopAt(at, now, p.failure);
  p.has_effect = true;
  p.exclusive = true;
  p.r[at->d] = *value;
  KERFBENCH_TAIL return next(p, at, now);
}

/// STREX: the result is in Rd, here `m`. The monitor of the Cortex-M3 remembers no address.
Stop storeExclusive(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t address = p.r[at->n] + at->number;
  if ((address & (at->kind - 1U)) != 0) {
    p.fault_address = address;
    return p.stopAt(at, now, Stop::kUnaligned);
  }
  p.has_effect = true;
  if (p.exclusive) {
    const std::uint32_t mask = 0xFFFFFFFFU >> (32U - 8U * at->kind);
    p.present.cycle = now;
    const bool is_done = p.writeElsewhere(at, address, at->kind, p.r[at->d] & mask);
    now = p.present.cycle;
    if (!is_done) return p.stopAt(at, now, p.failure);
  }
  p.r[at->m] = p.exclusive ? 0 : 1;
  p.exclusive = false;
  KERFBENCH_TAIL return next(p, at, now);
}

bool buildPush(const Encoding& e, Operation& op) {
  op.n = kSp;
  setList(op, e['l'] << kLr | e['r']);
  op.kind = kDown | kWritesBack;
  op.execute = &storeSeveral;
  return op.number != 0;
}

bool buildPop(const Encoding& e, Operation& op) {
  op.n = kSp;
  setList(op, e['p'] << kPc | e['r']);
  op.kind = kWritesBack;
  op.execute = &loadSeveral;
  return op.number != 0 && (e['p'] == 0 || e.mayBranch());
}

bool buildStoreSeveral16(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  setList(op, e['r']);
  op.kind = kWritesBack;
  op.execute = &storeSeveral;
  // A base that is not the first to be stored would be stored as an unknown value.
  return op.number != 0 && ((op.number >> op.n & 1U) == 0 || (op.number & ((1U << op.n) - 1)) == 0);
}

bool buildLoadSeveral16(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  setList(op, e['r']);
  op.kind = (op.number >> op.n & 1U) == 0 ? kWritesBack : 0;
  op.execute = &loadSeveral;
  return op.number != 0;
}

template <bool kLoads, bool kIsDown>
bool buildSeveral(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  setList(op, e['r']);
  const bool writes_back = e['w'] != 0;
  op.kind = static_cast<std::uint8_t>((kIsDown ? kDown : 0) | (writes_back ? kWritesBack : 0));
  op.execute = kLoads ? &loadSeveral : &storeSeveral;
  const bool has_pc = (op.number & 0x8000U) != 0;
  if (op.n == kPc || std::popcount(op.number) < 2 || (op.number & 0x2000U) != 0) return false;
  if (writes_back && (op.number >> op.n & 1U) != 0) return false;
  if (!kLoads) return !has_pc;
  return !has_pc || ((op.number & 0x4000U) == 0 && e.mayBranch());
}

template <bool kLoads>
bool buildDual(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.d = e.reg('t');
  op.m = e.reg('v');
  op.number = 4 * e['i'];
  if (e['u'] == 0) op.number = 0U - op.number;
  const bool writes_back = e['w'] != 0;
  op.kind = !writes_back ? 0 : e['p'] != 0 ? 1 : 2;
  op.execute = kLoads ? &loadDual : &storeDual;
  if ((e['p'] == 0 && !writes_back) || isSpOrPc(op.d) || isSpOrPc(op.m)) return false;
  if (writes_back && (op.n == op.d || op.n == op.m || op.n == kPc)) return false;
  return kLoads ? op.d != op.m : op.n != kPc;
}

bool buildLoadExclusive(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.d = e.reg('t');
  op.number = 4 * e['i'];
  op.kind = 4;
  op.execute = &loadExclusive;
  return op.n != kPc && !isSpOrPc(op.d);
}

bool buildStoreExclusive(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.d = e.reg('t');
  op.m = e.reg('d');
  op.number = 4 * e['i'];
  op.kind = 4;
  op.execute = &storeExclusive;
  return op.n != kPc && !isSpOrPc(op.d) && !isSpOrPc(op.m) && op.m != op.n && op.m != op.d;
}

bool buildLoadExclusivePart(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.d = e.reg('t');
  op.kind = e['s'] != 0 ? 2 : 1;
  op.execute = &loadExclusive;
  return op.n != kPc && !isSpOrPc(op.d);
}

bool buildStoreExclusivePart(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.d = e.reg('t');
  op.m = e.reg('d');
  op.kind = e['s'] != 0 ? 2 : 1;
  op.execute = &storeExclusive;
  return op.n != kPc && !isSpOrPc(op.d) && !isSpOrPc(op.m) && op.m != op.n && op.m != op.d;
}

constexpr EncodingRow kRows[] = {
    {"1011 010 l rrrrrrrr", buildPush},
    {"1011 110 p rrrrrrrr", buildPop},
    {"11000 nnn rrrrrrrr", buildStoreSeveral16},
    {"11001 nnn rrrrrrrr", buildLoadSeveral16},
    {"1110100 010 w 0 nnnn rrrrrrrrrrrrrrrr", buildSeveral<false, false>},
    {"1110100 010 w 1 nnnn rrrrrrrrrrrrrrrr", buildSeveral<true, false>},
    {"1110100 100 w 0 nnnn rrrrrrrrrrrrrrrr", buildSeveral<false, true>},
    {"1110100 100 w 1 nnnn rrrrrrrrrrrrrrrr", buildSeveral<true, true>},
    {"11101000 0100 nnnn tttt dddd iiiiiiii", buildStoreExclusive},
    {"11101000 0101 nnnn tttt 1111 iiiiiiii", buildLoadExclusive},
    {"11101000 1100 nnnn tttt 1111 010s dddd", buildStoreExclusivePart},
    {"11101000 1101 nnnn tttt 1111 010s 1111", buildLoadExclusivePart},
    {"1110100 p u 1 w 0 nnnn tttt vvvv iiiiiiii", buildDual<false>},
    {"1110100 p u 1 w 1 nnnn tttt vvvv iiiiiiii", buildDual<true>},
};

}  // namespace

std::span<const EncodingRow> multipleAccessRows() { return kRows; }

}  // namespace kerfbench::cortex_m_child
