// SPDX-License-Identifier: Apache-2.0
// Multiplication, division, saturation, fields of bits, extension and reversal (ARMv7-M 2010, A5.3.3, A5.3.12
// to A5.3.17).
#include <bit>
#include <limits>

#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

bool areOrdinary(std::initializer_list<std::uint32_t> numbers) {
  for (const std::uint32_t number : numbers) {
    if (isSpOrPc(number)) return false;
  }
  return true;
}

template <bool kFlags>
Stop multiply(Processor& p, Operation* at, Cycle now) {
  p.r[at->d] = p.r[at->n] * p.r[at->m];
  if constexpr (kFlags) p.setNegativeZero(p.r[at->d]);
  KERFBENCH_TAIL return next(p, at, now);
}

/// MLA and MLS; Ra is in `shift`.
template <bool kSubtracts>
Stop multiplyAccumulate(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t product = p.r[at->n] * p.r[at->m];
  p.r[at->d] = kSubtracts ? p.r[at->shift] - product : p.r[at->shift] + product;
  KERFBENCH_TAIL return next(p, at, now);
}

/// UMULL, UMLAL, SMULL, SMLAL; RdLo is in `shift`.
template <bool kSigned, bool kAccumulates>
Stop multiplyLong(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t n = p.r[at->n];
  const std::uint32_t m = p.r[at->m];
  std::uint64_t product = std::uint64_t{n} * m;
  if constexpr (kSigned) {
    const std::int64_t signed_n = static_cast<std::int32_t>(n);
    product = static_cast<std::uint64_t>(signed_n * static_cast<std::int32_t>(m));
  }
  if constexpr (kAccumulates) product += std::uint64_t{p.r[at->d]} << 32U | p.r[at->shift];
  p.r[at->shift] = static_cast<std::uint32_t>(product);
  p.r[at->d] = static_cast<std::uint32_t>(product >> 32U);
  KERFBENCH_TAIL return next(p, at, now);
}

template <bool kSigned>
Stop divide(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t n = p.r[at->n];
  const std::uint32_t m = p.r[at->m];
  if (m == 0 && p.traps_division) return p.stopAt(at, now, Stop::kDivisionByZero);
  std::uint32_t result = 0;
  if constexpr (kSigned) {
    const std::int64_t wide = static_cast<std::int32_t>(n);
    if (m != 0) result = static_cast<std::uint32_t>(wide / static_cast<std::int32_t>(m));
  } else if (m != 0) {
    result = n / m;
  }
  p.r[at->d] = result;
  KERFBENCH_TAIL return next(p, at, now);
}

/// SSAT and USAT of a register that is shifted left, or right where `kind` is set; `number` is the width.
template <bool kSigned>
Stop saturate(Processor& p, Operation* at, Cycle now) {
  const auto x = static_cast<std::int32_t>(p.r[at->n]);
  const std::int64_t value =
      at->kind != 0 ? x >> at->shift : static_cast<std::int32_t>(p.r[at->n] << at->shift);
  const std::int64_t range = std::int64_t{1} << (kSigned ? at->number - 1 : at->number);
  const std::int64_t least = kSigned ? -range : 0;
  const std::int64_t result = std::clamp(value, least, range - 1);
  if (result != value) p.saturated = true;
  p.r[at->d] = static_cast<std::uint32_t>(result);
  KERFBENCH_TAIL return next(p, at, now);
}

/// SBFX and UBFX: `number` is the width of the field.
template <bool kSigned>
Stop extractField(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t high = p.r[at->n] << (32 - at->shift - at->number);
  const unsigned down = 32 - at->number;
  p.r[at->d] = kSigned ? static_cast<std::uint32_t>(static_cast<std::int32_t>(high) >> down) : high >> down;
  KERFBENCH_TAIL return next(p, at, now);
}

/// BFI: `number` has a 1 for each bit of the destination that changes.
Stop insertField(Processor& p, Operation* at, Cycle now) {
  p.r[at->d] = (p.r[at->d] & ~at->number) | (p.r[at->n] << at->shift & at->number);
  KERFBENCH_TAIL return next(p, at, now);
}

Stop clearField(Processor& p, Operation* at, Cycle now) {
  p.r[at->d] &= ~at->number;
  KERFBENCH_TAIL return next(p, at, now);
}

Stop moveTop(Processor& p, Operation* at, Cycle now) {
  p.r[at->d] = (p.r[at->d] & 0xFFFFU) | at->number << 16U;
  KERFBENCH_TAIL return next(p, at, now);
}

/// SXTB, SXTH, UXTB, UXTH of a register that is turned right before.
template <typename Part>
Stop extend(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t turned = std::rotr(p.r[at->m], at->shift);
  p.r[at->d] = static_cast<std::uint32_t>(static_cast<std::int32_t>(static_cast<Part>(turned)));
  KERFBENCH_TAIL return next(p, at, now);
}

enum class Order : std::uint8_t { kWord, kHalfWords, kBits, kSignedHalfWord };

constexpr std::uint32_t swappedHalves(std::uint32_t x) {
  return (x & 0x00FF00FFU) << 8U | (x >> 8U & 0x00FF00FFU);
}

/// REV, REV16, RBIT, REVSH.
template <Order kOrder>
Stop reverse(Processor& p, Operation* at, Cycle now) {
  std::uint32_t x = swappedHalves(p.r[at->m]);
  if constexpr (kOrder == Order::kWord || kOrder == Order::kBits) x = std::rotl(x, 16);
  if constexpr (kOrder == Order::kSignedHalfWord) x = signExtended(x & 0xFFFFU, 16);
  if constexpr (kOrder == Order::kBits) {
    x = (x & 0x0F0F0F0FU) << 4U | (x >> 4U & 0x0F0F0F0FU);
    x = (x & 0x33333333U) << 2U | (x >> 2U & 0x33333333U);
    x = (x & 0x55555555U) << 1U | (x >> 1U & 0x55555555U);
  }
  p.r[at->d] = x;
  KERFBENCH_TAIL return next(p, at, now);
}

Stop countZeros(Processor& p, Operation* at, Cycle now) {
  p.r[at->d] = static_cast<std::uint32_t>(std::countl_zero(p.r[at->m]));
  KERFBENCH_TAIL return next(p, at, now);
}

void setRegisters(const Encoding& e, Operation& op) {
  op.d = e.reg('d');
  op.n = e.reg('n');
  op.m = e.reg('m');
}

bool buildMultiply16(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.m = op.d;
  op.execute = e.in_if_then ? &multiply<false> : &multiply<true>;
  return true;
}

bool buildMultiply(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = e.reg('a');
  op.execute = op.shift == kPc ? &multiply<false> : &multiplyAccumulate<false>;
  return areOrdinary({op.d, op.n, op.m}) && op.shift != kSp;
}

bool buildMultiplySubtract(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = e.reg('a');
  op.execute = &multiplyAccumulate<true>;
  return areOrdinary({op.d, op.n, op.m, op.shift});
}

template <bool kSigned, bool kAccumulates>
bool buildMultiplyLong(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = e.reg('l');
  op.execute = &multiplyLong<kSigned, kAccumulates>;
  return areOrdinary({op.d, op.n, op.m, op.shift}) && op.d != op.shift;
}

template <bool kSigned>
bool buildDivide(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.execute = &divide<kSigned>;
  return areOrdinary({op.d, op.n, op.m});
}

template <bool kSigned>
bool buildSaturate(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.kind = e.reg('s');
  op.shift = e.reg('i');
  op.number = e['w'] + (kSigned ? 1 : 0);
  op.execute = &saturate<kSigned>;
  // A shift right by 0 is SSAT16 or USAT16, which the Cortex-M3 has not.
  return areOrdinary({op.d, op.n}) && (op.kind == 0 || op.shift != 0);
}

template <bool kSigned>
bool buildExtractField(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = e.reg('i');
  op.number = e['w'] + 1;
  op.execute = &extractField<kSigned>;
  return areOrdinary({op.d, op.n}) && op.shift + op.number <= 32;
}

bool buildInsertField(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = e.reg('i');
  const std::uint32_t most = e['w'];
  if (most < op.shift) return false;
  op.number = std::numeric_limits<std::uint32_t>::max() >> (31 - most + op.shift) << op.shift;
  op.execute = op.n == kPc ? &clearField : &insertField;
  return !isSpOrPc(op.d) && op.n != kSp;
}

bool buildMoveTop(const Encoding& e, Operation& op) {
  op.d = e.reg('d');
  op.number = e['j'] << 12U | e['i'] << 11U | e['k'] << 8U | e['l'];
  op.execute = &moveTop;
  return !isSpOrPc(op.d);
}

template <Handler kHandler>
bool buildTwo(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.execute = kHandler;
  return true;
}

template <Handler kHandler>
bool buildExtend(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.shift = static_cast<std::uint8_t>(8 * e['r']);
  op.execute = kHandler;
  return areOrdinary({op.d, op.m});
}

/// The source is written twice, and must be the same register.
template <Handler kHandler>
bool buildReverse(const Encoding& e, Operation& op) {
  setRegisters(e, op);
  op.execute = kHandler;
  return areOrdinary({op.d, op.m}) && op.n == op.m;
}

constexpr EncodingRow kRows[] = {
    {"010000 1101 nnn ddd", buildMultiply16},
    {"10110010 00 mmm ddd", buildTwo<extend<std::int16_t>>},
    {"10110010 01 mmm ddd", buildTwo<extend<std::int8_t>>},
    {"10110010 10 mmm ddd", buildTwo<extend<std::uint16_t>>},
    {"10110010 11 mmm ddd", buildTwo<extend<std::uint8_t>>},
    {"10111010 00 mmm ddd", buildTwo<reverse<Order::kWord>>},
    {"10111010 01 mmm ddd", buildTwo<reverse<Order::kHalfWords>>},
    {"10111010 11 mmm ddd", buildTwo<reverse<Order::kSignedHalfWord>>},
    {"11111010 0000 1111 1111 dddd 10 rr mmmm", buildExtend<extend<std::int16_t>>},
    {"11111010 0001 1111 1111 dddd 10 rr mmmm", buildExtend<extend<std::uint16_t>>},
    {"11111010 0100 1111 1111 dddd 10 rr mmmm", buildExtend<extend<std::int8_t>>},
    {"11111010 0101 1111 1111 dddd 10 rr mmmm", buildExtend<extend<std::uint8_t>>},
    {"11111010 1001 nnnn 1111 dddd 1000 mmmm", buildReverse<reverse<Order::kWord>>},
    {"11111010 1001 nnnn 1111 dddd 1001 mmmm", buildReverse<reverse<Order::kHalfWords>>},
    {"11111010 1001 nnnn 1111 dddd 1010 mmmm", buildReverse<reverse<Order::kBits>>},
    {"11111010 1001 nnnn 1111 dddd 1011 mmmm", buildReverse<reverse<Order::kSignedHalfWord>>},
    {"11111010 1011 nnnn 1111 dddd 1000 mmmm", buildReverse<countZeros>},
    {"11111011 0000 nnnn aaaa dddd 0000 mmmm", buildMultiply},
    {"11111011 0000 nnnn aaaa dddd 0001 mmmm", buildMultiplySubtract},
    {"11111011 1000 nnnn llll dddd 0000 mmmm", buildMultiplyLong<true, false>},
    {"11111011 1010 nnnn llll dddd 0000 mmmm", buildMultiplyLong<false, false>},
    {"11111011 1100 nnnn llll dddd 0000 mmmm", buildMultiplyLong<true, true>},
    {"11111011 1110 nnnn llll dddd 0000 mmmm", buildMultiplyLong<false, true>},
    {"11111011 1001 nnnn 1111 dddd 1111 mmmm", buildDivide<true>},
    {"11111011 1011 nnnn 1111 dddd 1111 mmmm", buildDivide<false>},
    {"11110 i 101100 jjjj 0 kkk dddd llllllll", buildMoveTop},
    {"11110 0 1100 s 0 nnnn 0 iii dddd ii 0 wwwww", buildSaturate<true>},
    {"11110 0 1110 s 0 nnnn 0 iii dddd ii 0 wwwww", buildSaturate<false>},
    {"11110 0 110100 nnnn 0 iii dddd ii 0 wwwww", buildExtractField<true>},
    {"11110 0 111100 nnnn 0 iii dddd ii 0 wwwww", buildExtractField<false>},
    {"11110 0 110110 nnnn 0 iii dddd ii 0 wwwww", buildInsertField},
};

}  // namespace

std::span<const EncodingRow> arithmeticRows() { return kRows; }

}  // namespace kerfbench::cortex_m_child
