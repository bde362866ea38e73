// SPDX-License-Identifier: GPL-3.0-or-later
// Instructions that calculate with registers, each by its page of the manual (Atmel 2016).
#include "hil/source/avr_child/decoder.h"
#include "hil/source/avr_child/flags.h"
#include "hil/source/avr_child/words.h"

namespace kerfbench::avr_child {
namespace {

/// ADD, ADC, SUB, SBC and so on: Rd becomes what `kCalculate` makes of Rd and Rr, or of Rd and K.
using Calculation = std::uint8_t (*)(Processor& p, std::uint32_t d, std::uint32_t r);
enum class With : std::uint8_t { kRegister, kConstant };

template <Calculation kCalculate, With kWith>
void calculate(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t r = kWith == With::kRegister ? data[at->r] : at->number;
  data[at->d] = kCalculate(p, data[at->d], r);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

/// CP, CPC and CPI: only the flags are of interest.
template <Calculation kCalculate, With kWith>
void compare(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  (void)kCalculate(p, data[at->d], kWith == With::kRegister ? data[at->r] : at->number);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

std::uint8_t add(Processor& p, std::uint32_t d, std::uint32_t r) { return sum(p, d, r); }
std::uint8_t addWithCarry(Processor& p, std::uint32_t d, std::uint32_t r) { return sum(p, d, r, p.carry()); }
std::uint8_t subtract(Processor& p, std::uint32_t d, std::uint32_t r) { return difference(p, d, r); }
std::uint8_t subtractAbove(Processor& p, std::uint32_t d, std::uint32_t r) {
  return differenceAbove(p, d, r);
}
std::uint8_t bothBits(Processor& p, std::uint32_t d, std::uint32_t r) { return logical(p, d & r); }
std::uint8_t eitherBit(Processor& p, std::uint32_t d, std::uint32_t r) { return logical(p, d | r); }
std::uint8_t otherBits(Processor& p, std::uint32_t d, std::uint32_t r) { return logical(p, d ^ r); }

std::uint8_t complement(Processor& p, std::uint32_t d, std::uint32_t /*r*/) {
  setCarry(p, 1);
  return logical(p, d ^ 0xFFU);
}
std::uint8_t negate(Processor& p, std::uint32_t d, std::uint32_t /*r*/) { return difference(p, 0, d); }
std::uint8_t increment(Processor& p, std::uint32_t d, std::uint32_t /*r*/) {
  return logical(p, (d + 1) & 0xFFU, d == 0x7F ? kOverflowFlag : 0);
}
std::uint8_t decrement(Processor& p, std::uint32_t d, std::uint32_t /*r*/) {
  return logical(p, (d - 1) & 0xFFU, d == 0x80 ? kOverflowFlag : 0);
}
std::uint8_t shiftRight(Processor& p, std::uint32_t d, std::uint32_t /*r*/) { return shifted(p, d, d >> 1U); }
std::uint8_t shiftSignedRight(Processor& p, std::uint32_t d, std::uint32_t /*r*/) {
  return shifted(p, d, d >> 1U | (d & 0x80U));
}
std::uint8_t rotateRight(Processor& p, std::uint32_t d, std::uint32_t /*r*/) {
  return shifted(p, d, d >> 1U | p.carry() << 7U);
}

/// ADIW and SBIW.
template <bool kAdds>
void calculatePair(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t before = pairIn(data, at->d);
  const std::uint32_t result = kAdds ? before + at->number : before - at->number;
  const std::uint32_t turned_on = ~before & result & 0x8000U;
  const std::uint32_t turned_off = before & ~result & 0x8000U;
  setCarry(p, (kAdds ? turned_off : turned_on) >> 15U);
  setSigns(p, result >> 8U, (kAdds ? turned_on : turned_off) >> 7U);
  p.zero = result & 0xFFFFU;
  setWordIn(data, at->d, result);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

/// MUL, MULS, MULSU, and their fractional forms, whose product is shifted left.
template <typename D, typename R, bool kIsFraction>
void multiply(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const int signed_product = static_cast<D>(data[at->d]) * static_cast<R>(data[at->r]);
  const auto product = static_cast<std::uint32_t>(signed_product);
  const std::uint32_t result = (kIsFraction ? product << 1U : product) & 0xFFFFU;
  setCarry(p, product >> 15U & 1U);
  p.zero = result;
  setWordIn(data, 0, result);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

void move(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->d] = data[at->r];
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void movePair(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  setWordIn(data, at->d, pairIn(data, at->r));
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void loadConstant(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->d] = static_cast<std::uint8_t>(at->number);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void swapNibbles(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t d = data[at->d];
  data[at->d] = static_cast<std::uint8_t>(d << 4U | d >> 4U);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

template <Handler kHandler>
bool buildRegisters(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.reg('d');
  op.r = e.reg('r');
  return true;
}

/// Registers 16 to 31 and a constant.
template <Handler kHandler>
bool buildConstant(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = static_cast<std::uint8_t>(16 + e['d']);
  op.number = static_cast<std::uint16_t>(e['K']);
  return true;
}

template <Handler kHandler>
bool buildUpper(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = static_cast<std::uint8_t>(16 + e['d']);
  op.r = static_cast<std::uint8_t>(16 + e['r']);
  return true;
}

bool buildMovePair(const Encoding& e, Operation& op) {
  op.execute = &movePair;
  op.d = static_cast<std::uint8_t>(2 * e['d']);
  op.r = static_cast<std::uint8_t>(2 * e['r']);
  return true;
}

template <bool kAdds>
bool buildCalculatePair(const Encoding& e, Operation& op) {
  op.execute = &calculatePair<kAdds>;
  op.d = static_cast<std::uint8_t>(24 + 2 * e['d']);
  op.number = static_cast<std::uint16_t>(e['K']);
  return true;
}

template <Calculation kCalculate>
constexpr auto kOfRegisters = &buildRegisters<&calculate<kCalculate, With::kRegister>>;
template <Calculation kCalculate>
constexpr auto kOfConstant = &buildConstant<&calculate<kCalculate, With::kConstant>>;
template <Calculation kCalculate>
constexpr auto kOfOne = &buildRegisters<&calculate<kCalculate, With::kConstant>>;
template <Calculation kCalculate>
constexpr auto kCompared = &buildRegisters<&compare<kCalculate, With::kRegister>>;
template <typename D, typename R, bool kIsFraction = true>
constexpr auto kProduct = &buildUpper<&multiply<D, R, kIsFraction>>;

constexpr EncodingRow kRows[] = {
    {"0000 11rd dddd rrrr", kOfRegisters<add>},
    {"0001 11rd dddd rrrr", kOfRegisters<addWithCarry>},
    {"0001 10rd dddd rrrr", kOfRegisters<subtract>},
    {"0000 10rd dddd rrrr", kOfRegisters<subtractAbove>},
    {"0010 00rd dddd rrrr", kOfRegisters<bothBits>},
    {"0010 10rd dddd rrrr", kOfRegisters<eitherBit>},
    {"0010 01rd dddd rrrr", kOfRegisters<otherBits>},
    {"0101 KKKK dddd KKKK", kOfConstant<subtract>},
    {"0100 KKKK dddd KKKK", kOfConstant<subtractAbove>},
    {"0111 KKKK dddd KKKK", kOfConstant<bothBits>},
    {"0110 KKKK dddd KKKK", kOfConstant<eitherBit>},
    {"0001 01rd dddd rrrr", kCompared<subtract>},
    {"0000 01rd dddd rrrr", kCompared<subtractAbove>},
    {"0011 KKKK dddd KKKK", buildConstant<&compare<subtract, With::kConstant>>},
    {"1001 010d dddd 0000", kOfOne<complement>},
    {"1001 010d dddd 0001", kOfOne<negate>},
    {"1001 010d dddd 0011", kOfOne<increment>},
    {"1001 010d dddd 1010", kOfOne<decrement>},
    {"1001 010d dddd 0110", kOfOne<shiftRight>},
    {"1001 010d dddd 0101", kOfOne<shiftSignedRight>},
    {"1001 010d dddd 0111", kOfOne<rotateRight>},
    {"1001 010d dddd 0010", buildRegisters<&swapNibbles>},
    {"0010 11rd dddd rrrr", buildRegisters<&move>},
    {"0000 0001 dddd rrrr", buildMovePair},
    {"1110 KKKK dddd KKKK", buildConstant<&loadConstant>},
    {"1001 0110 KKdd KKKK", buildCalculatePair<true>},
    {"1001 0111 KKdd KKKK", buildCalculatePair<false>},
    {"1001 11rd dddd rrrr", buildRegisters<&multiply<std::uint8_t, std::uint8_t, false>>},
    {"0000 0010 dddd rrrr", kProduct<std::int8_t, std::int8_t, false>},
    {"0000 0011 0ddd 0rrr", kProduct<std::int8_t, std::uint8_t, false>},
    {"0000 0011 0ddd 1rrr", kProduct<std::uint8_t, std::uint8_t>},
    {"0000 0011 1ddd 0rrr", kProduct<std::int8_t, std::int8_t>},
    {"0000 0011 1ddd 1rrr", kProduct<std::int8_t, std::uint8_t>},
};

}  // namespace

std::span<const EncodingRow> arithmeticRows() { return kRows; }

}  // namespace kerfbench::avr_child
