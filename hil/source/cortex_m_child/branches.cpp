// SPDX-License-Identifier: Apache-2.0
// Branches: direct ones, by registers, by tables, and comparisons with zero (ARMv7-M 2010, A4.3).
#include <utility>

#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr unsigned kConditions = 14;

template <unsigned kCondition>
Stop branchIf(Processor& p, Operation* at, Cycle now) {
  if (!holds(p, kCondition)) KERFBENCH_TAIL return next(p, at, now);
  KERFBENCH_TAIL return branch(p, at, now);
}

template <unsigned kCondition>
Stop branchOutIf(Processor& p, Operation* at, Cycle now) {
  if (!holds(p, kCondition)) KERFBENCH_TAIL return next(p, at, now);
  p.fault_address = at->number;
  return p.stopAt(at, now, Stop::kBadFetch);
}

Stop branchAlways(Processor& p, Operation* at, Cycle now) { KERFBENCH_TAIL return branch(p, at, now); }

Stop branchOut(Processor& p, Operation* at, Cycle now) {
  p.fault_address = at->number;
  return p.stopAt(at, now, Stop::kBadFetch);
}

Stop branchWithLink(Processor& p, Operation* at, Cycle now) {
  p.r[kLr] = (at->pc + 4) | 1U;
  KERFBENCH_TAIL return branch(p, at, now);
}

/// CBZ, and CBNZ where kWantsZero is false.
template <bool kWantsZero>
Stop compareAndBranch(Processor& p, Operation* at, Cycle now) {
  if ((p.r[at->n] == 0) != kWantsZero) KERFBENCH_TAIL return next(p, at, now);
  KERFBENCH_TAIL return branch(p, at, now);
}

template <bool kWantsZero>
Stop compareAndBranchOut(Processor& p, Operation* at, Cycle now) {
  if ((p.r[at->n] == 0) != kWantsZero) KERFBENCH_TAIL return next(p, at, now);
  KERFBENCH_TAIL return branchOut(p, at, now);
}

Stop branchExchange(Processor& p, Operation* at, Cycle now) {
  p.pc = p.r[at->m];
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

Stop branchExchangeWithLink(Processor& p, Operation* at, Cycle now) {
  p.pc = p.r[at->m];
  p.r[kLr] = (at->pc + 2) | 1U;
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

/// MOV to the PC stays in Thumb whatever bit 0 says.
Stop moveToPc(Processor& p, Operation* at, Cycle now) {
  p.pc = p.r[at->m] | 1U;
  if (p.pc >= kExceptionReturns) {
    p.fault_address = p.pc;
    return p.stopAt(at, now, Stop::kBadFetch);
  }
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

Stop addToPc(Processor& p, Operation* at, Cycle now) {
  p.pc = (at->pc + 4 + p.r[at->m]) | 1U;
  if (p.pc >= kExceptionReturns) {
    p.fault_address = p.pc;
    return p.stopAt(at, now, Stop::kBadFetch);
  }
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

/// TBB and TBH: an entry of a table says how many half-words the branch leads forwards.
template <unsigned kBytes>
Stop tableBranch(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t table = at->n == kPc ? at->pc + 4 : p.r[at->n];
  p.present.cycle = now;
  const auto entry = p.readElsewhere(at, table + kBytes * p.r[at->m], kBytes);
  now = p.present.cycle;
  if (!entry) return p.stopAt(at, now, p.failure);
  p.pc = (at->pc + 4 + 2 * *entry) | 1U;
  KERFBENCH_TAIL return jumpToPc(p, at, now);
}

struct Pair {
  Handler inside{};
  Handler outside{};
};

template <std::size_t... kCondition>
constexpr std::array<Pair, sizeof...(kCondition)> pairs(std::index_sequence<kCondition...> /*all*/) {
  return {Pair{&branchIf<kCondition>, &branchOutIf<kCondition>}...};
}

constexpr auto kConditional = pairs(std::make_index_sequence<kConditions>());

bool setConditional(const Encoding& e, Operation& op, std::uint32_t offset) {
  const Pair pair = kConditional[e['c']];
  setBranch(e, op, e.readPc() + offset, pair.inside, pair.outside);
  return !e.in_if_then;
}

bool buildBranchIf(const Encoding& e, Operation& op) {
  if (e['c'] >= kConditions) return false;
  return setConditional(e, op, signExtended(e['i'] << 1U, 9));
}

bool buildBranch(const Encoding& e, Operation& op) {
  setBranch(e, op, e.readPc() + signExtended(e['i'] << 1U, 12), &branchAlways, &branchOut);
  return e.mayBranch();
}

bool buildWideBranchIf(const Encoding& e, Operation& op) {
  if (e['c'] >= kConditions) return false;
  const std::uint32_t offset = e['s'] << 20U | e['k'] << 19U | e['j'] << 18U | e['h'] << 12U | e['l'] << 1U;
  return setConditional(e, op, signExtended(offset, 21));
}

std::uint32_t farOffset(const Encoding& e) {
  const std::uint32_t i1 = 1U ^ e['j'] ^ e['s'];
  const std::uint32_t i2 = 1U ^ e['k'] ^ e['s'];
  return signExtended(e['s'] << 24U | i1 << 23U | i2 << 22U | e['h'] << 12U | e['l'] << 1U, 25);
}

bool buildWideBranch(const Encoding& e, Operation& op) {
  setBranch(e, op, e.readPc() + farOffset(e), &branchAlways, &branchOut);
  return e.mayBranch();
}

bool buildBranchWithLink(const Encoding& e, Operation& op) {
  setBranch(e, op, e.readPc() + farOffset(e), &branchWithLink, &branchOut);
  return e.mayBranch();
}

template <bool kWantsZero>
bool buildCompareAndBranch(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  setBranch(e, op, e.readPc() + (e['i'] << 1U), &compareAndBranch<kWantsZero>,
            &compareAndBranchOut<kWantsZero>);
  return !e.in_if_then;
}

template <Handler kHandler>
bool buildByRegister(const Encoding& e, Operation& op) {
  op.m = e.reg('m');
  op.execute = kHandler;
  return e.mayBranch() && op.m != kPc;
}

template <unsigned kBytes>
bool buildTableBranch(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.m = e.reg('m');
  op.execute = &tableBranch<kBytes>;
  return e.mayBranch() && op.n != kSp && !isSpOrPc(op.m);
}

constexpr EncodingRow kRows[] = {
    {"010001 00 1 mmmm 111", buildByRegister<addToPc>},
    {"010001 10 1 mmmm 111", buildByRegister<moveToPc>},
    {"010001 11 0 mmmm 000", buildByRegister<branchExchange>},
    {"010001 11 1 mmmm 000", buildByRegister<branchExchangeWithLink>},
    {"1011 0 0 i 1 iiiii nnn", buildCompareAndBranch<true>},
    {"1011 1 0 i 1 iiiii nnn", buildCompareAndBranch<false>},
    {"1101 cccc iiiiiiii", buildBranchIf},
    {"11100 iiiiiiiiiii", buildBranch},
    {"11110 s cccc hhhhhh 10 j 0 k lllllllllll", buildWideBranchIf},
    {"11110 s hhhhhhhhhh 10 j 1 k lllllllllll", buildWideBranch},
    {"11110 s hhhhhhhhhh 11 j 1 k lllllllllll", buildBranchWithLink},
    {"11101000 1101 nnnn 1111 0000 0000 mmmm", buildTableBranch<1>},
    {"11101000 1101 nnnn 1111 0000 0001 mmmm", buildTableBranch<2>},
};

}  // namespace

std::span<const EncodingRow> branchRows() { return kRows; }

void setBranch(const Encoding& e, Operation& op, std::uint32_t target, Handler inside, Handler outside) {
  Operation* const there = e.processor.operationAt(target);
  op.execute = there != nullptr ? inside : outside;
  if (there != nullptr) {
    op.target = there;
  } else {
    op.number = target;
  }
}

}  // namespace kerfbench::cortex_m_child
