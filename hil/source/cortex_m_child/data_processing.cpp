// SPDX-License-Identifier: Apache-2.0
// Data processing with two operands, of which the second is a number or a register that may be shifted:
// moves, logic, sums, comparisons, shifts (ARMv7-M 2010, A5.2.1, A5.3.1, A5.3.11).
#include <bit>
#include <utility>

#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

enum class Does : std::uint8_t { kAnd, kBic, kOrr, kOrn, kEor, kMov, kMvn, kAdd, kAdc, kSub, kSbc, kRsb };
enum class Operand : std::uint8_t { kNumber, kRegister, kLsl, kLsr, kAsr, kRor };
/// SP keeps no bits 0 and 1. A comparison has only flags.
enum class Target : std::uint8_t { kRegister, kStack, kNone };
constexpr unsigned kDoes = 12, kOperands = 6, kTargets = 3;

struct Shifted {
  std::uint32_t value{};
  std::uint32_t carry{};
};

/// A register by its shift of 1 to 31, or 32 where that is possible. RRX is ROR by 0.
template <Operand kOperand>
Shifted shifted(std::uint32_t x, unsigned amount, std::uint32_t carry) {
  if constexpr (kOperand == Operand::kLsl) return {x << amount, x >> (32 - amount) & 1U};
  const std::uint32_t last = x >> ((amount - 1) & 31U) & 1U;
  if constexpr (kOperand == Operand::kLsr)
    return {static_cast<std::uint32_t>(std::uint64_t{x} >> amount), last};
  if constexpr (kOperand == Operand::kAsr) {
    const auto wide = static_cast<std::int64_t>(static_cast<std::int32_t>(x));
    return {static_cast<std::uint32_t>(wide >> amount), last};
  }
  if (amount == 0) return {x >> 1U | carry << 31U, x & 1U};
  return {std::rotr(x, static_cast<int>(amount)), last};
}

template <Operand kOperand>
Shifted secondOperand(const Processor& p, const Operation* at) {
  if constexpr (kOperand == Operand::kNumber)
    return {at->number, at->kind != 0 ? at->number >> 31U : p.carry};
  if constexpr (kOperand == Operand::kRegister) return {p.r[at->m], p.carry};
  return shifted<kOperand>(p.r[at->m], at->shift, p.carry);
}

constexpr bool isLogical(Does does) { return does <= Does::kMvn; }

template <Does kDoes>
std::uint32_t logical(std::uint32_t a, std::uint32_t b) {
  if constexpr (kDoes == Does::kAnd) return a & b;
  if constexpr (kDoes == Does::kBic) return a & ~b;
  if constexpr (kDoes == Does::kOrr) return a | b;
  if constexpr (kDoes == Does::kOrn) return a | ~b;
  if constexpr (kDoes == Does::kEor) return a ^ b;
  if constexpr (kDoes == Does::kMov) return b;
  return ~b;
}

/// AddWithCarry() of ARMv7-M.
template <bool kFlags>
std::uint32_t sum(Processor& p, std::uint32_t a, std::uint32_t b, std::uint32_t carry) {
  const std::uint64_t wide = std::uint64_t{a} + b + carry;
  const auto result = static_cast<std::uint32_t>(wide);
  if constexpr (kFlags) {
    p.setNegativeZero(result);
    p.carry = static_cast<std::uint32_t>(wide >> 32U);
    p.overflow = (a ^ result) & (b ^ result);
  }
  return result;
}

template <Does kDoes, bool kFlags>
std::uint32_t arithmetic(Processor& p, std::uint32_t a, std::uint32_t b) {
  if constexpr (kDoes == Does::kAdd) return sum<kFlags>(p, a, b, 0);
  if constexpr (kDoes == Does::kAdc) return sum<kFlags>(p, a, b, p.carry);
  if constexpr (kDoes == Does::kSub) return sum<kFlags>(p, a, ~b, 1);
  if constexpr (kDoes == Does::kSbc) return sum<kFlags>(p, a, ~b, p.carry);
  return sum<kFlags>(p, ~a, b, 1);
}

template <Does kDoes, Operand kOperand, Target kTarget, bool kFlags>
Stop process(Processor& p, Operation* at, Cycle now) {
  const Shifted b = secondOperand<kOperand>(p, at);
  std::uint32_t result = 0;
  if constexpr (isLogical(kDoes)) {
    result = logical<kDoes>(p.r[at->n], b.value);
    if constexpr (kFlags) {
      p.setNegativeZero(result);
      p.carry = b.carry;
    }
  } else {
    result = arithmetic<kDoes, kFlags>(p, p.r[at->n], b.value);
  }
  if constexpr (kTarget == Target::kRegister) p.r[at->d] = result;
  if constexpr (kTarget == Target::kStack) p.r[kSp] = result & ~3U;
  KERFBENCH_TAIL return next(p, at, now);
}

/// Shifts whose amount is in a register: the low byte of it, so that it may be more than 32.
template <Operand kOperand>
Shifted shiftedFar(std::uint32_t x, unsigned amount, std::uint32_t carry) {
  if (amount == 0) return {x, carry};
  if constexpr (kOperand == Operand::kRor) {
    const unsigned turn = amount & 31U;
    return turn == 0 ? Shifted{x, x >> 31U} : shifted<kOperand>(x, turn, carry);
  }
  if constexpr (kOperand == Operand::kAsr) return shifted<kOperand>(x, std::min(amount, 32U), carry);
  if (amount < 32) return shifted<kOperand>(x, amount, carry);
  if (amount > 32) return {0, 0};
  return {0, kOperand == Operand::kLsl ? x & 1U : x >> 31U};
}

template <Operand kOperand, bool kFlags>
Stop shiftByRegister(Processor& p, Operation* at, Cycle now) {
  const Shifted result = shiftedFar<kOperand>(p.r[at->n], p.r[at->m] & 0xFFU, p.carry);
  if constexpr (kFlags) {
    p.setNegativeZero(result.value);
    p.carry = result.carry;
  }
  p.r[at->d] = result.value;
  KERFBENCH_TAIL return next(p, at, now);
}

constexpr std::size_t placeOf(Does does, Operand operand, Target target, bool flags) {
  return ((static_cast<std::size_t>(does) * kOperands + static_cast<std::size_t>(operand)) * kTargets +
          static_cast<std::size_t>(target)) *
             2 +
         (flags ? 1 : 0);
}

template <std::size_t kPlace>
constexpr Handler handlerAt() {
  constexpr auto kTarget = static_cast<Target>(kPlace / 2 % kTargets);
  constexpr auto kOperand = static_cast<Operand>(kPlace / 2 / kTargets % kOperands);
  constexpr auto kOperation = static_cast<Does>(kPlace / 2 / kTargets / kOperands);
  return &process<kOperation, kOperand, kTarget, (kPlace & 1U) != 0>;
}

template <std::size_t... kPlaces>
constexpr std::array<Handler, sizeof...(kPlaces)> tableOf(std::index_sequence<kPlaces...> /*places*/) {
  return {handlerAt<kPlaces>()...};
}

constexpr auto kHandlers = tableOf(std::make_index_sequence<std::size_t{kDoes} * kOperands * kTargets * 2>());

/// Sets handler and destination; the operands are set already.
void set(Operation& op, Does does, Operand operand, unsigned d, bool flags) {
  op.d = static_cast<std::uint8_t>(d);
  op.execute = kHandlers[placeOf(does, operand, d == kSp ? Target::kStack : Target::kRegister, flags)];
}

void setComparison(Operation& op, Does does, Operand operand) {
  op.execute = kHandlers[placeOf(does, operand, Target::kNone, true)];
}

/// DecodeImmShift(): LSR and ASR by 0 are by 32, LSL by 0 is none, ROR by 0 is RRX.
Operand setShift(Operation& op, unsigned type, unsigned amount) {
  op.shift = static_cast<std::uint8_t>(amount == 0 && (type == 1 || type == 2) ? 32 : amount);
  if (type == 0 && amount == 0) return Operand::kRegister;
  constexpr Operand kOfType[] = {Operand::kLsl, Operand::kLsr, Operand::kAsr, Operand::kRor};
  return kOfType[type & 3U];
}

/// ThumbExpandImm(); `kind` says whether it sets C.
bool setModifiedImmediate(Operation& op, std::uint32_t coded) {
  const std::uint32_t byte = coded & 0xFFU;
  op.kind = 0;
  if (coded >> 10U != 0) {
    op.number = std::rotr(0x80U | (coded & 0x7FU), static_cast<int>(coded >> 7U));
    op.kind = 1;
    return true;
  }
  constexpr std::uint32_t kRepeats[] = {1, 0x00010001, 0x01000100, 0x01010101};
  op.number = byte * kRepeats[coded >> 8U & 3U];
  return byte != 0 || coded >> 8U == 0;
}

/// The sixteen operations of the wide encodings, with the rules about SP and PC that they share.
bool setWide(const Encoding& e, Operation& op, Operand operand) {
  constexpr std::uint8_t kNoOperation = 0xFF;
  constexpr std::uint8_t kOf[] = {0,
                                  1,
                                  2,
                                  3,
                                  4,
                                  kNoOperation,
                                  kNoOperation,
                                  kNoOperation,
                                  7,
                                  kNoOperation,
                                  8,
                                  10,
                                  kNoOperation,
                                  9,
                                  11,
                                  kNoOperation};
  const std::uint32_t code = e['o'];
  if (kOf[code] == kNoOperation) return false;
  auto does = static_cast<Does>(kOf[code]);
  const bool flags = e['S'] != 0;
  const std::uint32_t n = e['n'];
  const std::uint32_t d = e['d'];
  op.n = static_cast<std::uint8_t>(n);
  const bool has_comparison = code == 0 || code == 4 || code == 8 || code == 13;
  if (d == kPc && flags && has_comparison) {
    setComparison(op, does, operand);
    return n != kPc && (n != kSp || code >= 8);
  }
  if (n == kPc && (code == 2 || code == 3)) {
    does = code == 2 ? Does::kMov : Does::kMvn;
    op.n = 0;
  } else if (n == kPc || (n == kSp && code != 8 && code != 13)) {
    return false;
  }
  const bool may_be_stack = (does == Does::kAdd || does == Does::kSub) && n == kSp;
  set(op, does, operand, d, flags);
  return d != kPc && (d != kSp || may_be_stack);
}

bool buildWideNumber(const Encoding& e, Operation& op) {
  return setModifiedImmediate(op, e['i']) && setWide(e, op, Operand::kNumber);
}

bool buildWideRegister(const Encoding& e, Operation& op) {
  op.m = e.reg('m');
  const Operand operand = setShift(op, e['t'], e['i']);
  if (op.m == kPc) return false;
  // MOV.W of and to SP exists without shift and flags.
  if (e['o'] == 2 && e['n'] == kPc && operand == Operand::kRegister && e['S'] == 0) {
    set(op, Does::kMov, operand, e['d'], false);
    return e['d'] != kPc && (e['d'] != kSp || op.m != kSp);
  }
  if (op.m == kSp || (e['d'] == kSp && (e['t'] != 0 || e['i'] > 3))) return false;
  return setWide(e, op, operand);
}

template <Does kDoes>
bool buildWideSum(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.number = e['i'];
  if (op.n == kPc) {
    op.number = e.alignedPc() + (kDoes == Does::kAdd ? op.number : 0U - op.number);
    set(op, Does::kMov, Operand::kNumber, e['d'], false);
    return !isSpOrPc(e['d']);
  }
  set(op, kDoes, Operand::kNumber, e['d'], false);
  return e['d'] != kPc && (e['d'] != kSp || op.n == kSp);
}

bool buildMoveWide(const Encoding& e, Operation& op) {
  op.number = e['j'] << 12U | e['i'] << 11U | e['k'] << 8U | e['l'];
  set(op, Does::kMov, Operand::kNumber, e['d'], false);
  return !isSpOrPc(e['d']);
}

template <Does kDoes>
bool buildSumOfRegisters(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.m = e.reg('m');
  set(op, kDoes, Operand::kRegister, e['d'], !e.in_if_then);
  return true;
}

template <Does kDoes>
bool buildSumWithNumber(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.number = e['i'];
  set(op, kDoes, Operand::kNumber, e['d'], !e.in_if_then);
  return true;
}

/// MOV, ADD and SUB of a byte, where destination and first operand are one.
template <Does kDoes>
bool buildByte(const Encoding& e, Operation& op) {
  op.n = e.reg('d');
  op.number = e['i'];
  set(op, kDoes, Operand::kNumber, e['d'], !e.in_if_then);
  return true;
}

bool buildCompareByte(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.number = e['i'];
  setComparison(op, Does::kSub, Operand::kNumber);
  return true;
}

bool buildShift(const Encoding& e, Operation& op) {
  op.m = e.reg('m');
  set(op, Does::kMov, setShift(op, e['t'], e['i']), e['d'], !e.in_if_then);
  return true;
}

template <Does kDoes>
bool buildTwo(const Encoding& e, Operation& op) {
  op.n = e.reg('d');
  op.m = e.reg('m');
  set(op, kDoes, Operand::kRegister, e['d'], !e.in_if_then);
  return true;
}

template <Does kDoes>
bool buildTwoCompared(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.m = e.reg('m');
  setComparison(op, kDoes, Operand::kRegister);
  return true;
}

bool buildNegation(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  set(op, Does::kRsb, Operand::kNumber, e['d'], !e.in_if_then);
  return true;
}

void setRegisterShift(Operation& op, unsigned type, bool flags) {
  constexpr Handler kOf[4][2] = {
      {&shiftByRegister<Operand::kLsl, false>, &shiftByRegister<Operand::kLsl, true>},
      {&shiftByRegister<Operand::kLsr, false>, &shiftByRegister<Operand::kLsr, true>},
      {&shiftByRegister<Operand::kAsr, false>, &shiftByRegister<Operand::kAsr, true>},
      {&shiftByRegister<Operand::kRor, false>, &shiftByRegister<Operand::kRor, true>}};
  op.execute = kOf[type & 3U][flags ? 1 : 0];
}

template <unsigned kType>
bool buildShiftByRegister(const Encoding& e, Operation& op) {
  op.d = op.n = e.reg('d');
  op.m = e.reg('m');
  setRegisterShift(op, kType, !e.in_if_then);
  return true;
}

bool buildWideShift(const Encoding& e, Operation& op) {
  op.d = e.reg('d');
  op.n = e.reg('n');
  op.m = e.reg('m');
  setRegisterShift(op, e['t'], e['S'] != 0);
  return !isSpOrPc(op.d) && !isSpOrPc(op.n) && !isSpOrPc(op.m);
}

/// ADD and MOV of any two registers but to the PC, which are branches. The PC as a source is a number.
template <Does kDoes>
bool buildHigh(const Encoding& e, Operation& op) {
  op.n = e.reg('d');
  op.m = e.reg('m');
  const bool is_pc = op.m == kPc;
  if (is_pc) op.number = e.readPc();
  set(op, kDoes, is_pc ? Operand::kNumber : Operand::kRegister, e['d'], false);
  return true;
}

bool buildCompareHigh(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.m = e.reg('m');
  setComparison(op, Does::kSub, Operand::kRegister);
  return op.n != kPc && op.m != kPc && (op.n >= 8 || op.m >= 8);
}

bool buildAddress(const Encoding& e, Operation& op) {
  op.number = e.alignedPc() + 4 * e['i'];
  set(op, Does::kMov, Operand::kNumber, e['d'], false);
  return true;
}

bool buildStackAddress(const Encoding& e, Operation& op) {
  op.n = kSp;
  op.number = 4 * e['i'];
  set(op, Does::kAdd, Operand::kNumber, e['d'], false);
  return true;
}

template <Does kDoes>
bool buildStackMove(const Encoding& e, Operation& op) {
  op.n = kSp;
  op.number = 4 * e['i'];
  set(op, kDoes, Operand::kNumber, kSp, false);
  return true;
}

constexpr EncodingRow kRows[] = {
    {"0001100 mmm nnn ddd", buildSumOfRegisters<Does::kAdd>},
    {"0001101 mmm nnn ddd", buildSumOfRegisters<Does::kSub>},
    {"0001110 iii nnn ddd", buildSumWithNumber<Does::kAdd>},
    {"0001111 iii nnn ddd", buildSumWithNumber<Does::kSub>},
    {"000 tt iiiii mmm ddd", buildShift},
    {"00100 ddd iiiiiiii", buildByte<Does::kMov>},
    {"00101 nnn iiiiiiii", buildCompareByte},
    {"00110 ddd iiiiiiii", buildByte<Does::kAdd>},
    {"00111 ddd iiiiiiii", buildByte<Does::kSub>},
    {"010000 0000 mmm ddd", buildTwo<Does::kAnd>},
    {"010000 0001 mmm ddd", buildTwo<Does::kEor>},
    {"010000 0010 mmm ddd", buildShiftByRegister<0>},
    {"010000 0011 mmm ddd", buildShiftByRegister<1>},
    {"010000 0100 mmm ddd", buildShiftByRegister<2>},
    {"010000 0101 mmm ddd", buildTwo<Does::kAdc>},
    {"010000 0110 mmm ddd", buildTwo<Does::kSbc>},
    {"010000 0111 mmm ddd", buildShiftByRegister<3>},
    {"010000 1000 mmm nnn", buildTwoCompared<Does::kAnd>},
    {"010000 1001 nnn ddd", buildNegation},
    {"010000 1010 mmm nnn", buildTwoCompared<Does::kSub>},
    {"010000 1011 mmm nnn", buildTwoCompared<Does::kAdd>},
    {"010000 1100 mmm ddd", buildTwo<Does::kOrr>},
    {"010000 1110 mmm ddd", buildTwo<Does::kBic>},
    {"010000 1111 mmm ddd", buildTwo<Does::kMvn>},
    // ADD and MOV to the PC come before these, among the branches.
    {"010001 00 d mmmm ddd", buildHigh<Does::kAdd>},
    {"010001 01 n mmmm nnn", buildCompareHigh},
    {"010001 10 d mmmm ddd", buildHigh<Does::kMov>},
    {"10100 ddd iiiiiiii", buildAddress},
    {"10101 ddd iiiiiiii", buildStackAddress},
    {"10110000 0 iiiiiii", buildStackMove<Does::kAdd>},
    {"10110000 1 iiiiiii", buildStackMove<Does::kSub>},
    {"11110 i 0 oooo S nnnn 0 iii dddd iiiiiiii", buildWideNumber},
    {"1110101 oooo S nnnn 0 iii dddd ii tt mmmm", buildWideRegister},
    {"11110 i 100000 nnnn 0 iii dddd iiiiiiii", buildWideSum<Does::kAdd>},
    {"11110 i 101010 nnnn 0 iii dddd iiiiiiii", buildWideSum<Does::kSub>},
    {"11110 i 100100 jjjj 0 kkk dddd llllllll", buildMoveWide},
    {"11111010 0 tt S nnnn 1111 dddd 0000 mmmm", buildWideShift},
};

}  // namespace

std::span<const EncodingRow> dataProcessingRows() { return kRows; }

}  // namespace kerfbench::cortex_m_child
