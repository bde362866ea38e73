// SPDX-License-Identifier: Apache-2.0
// Loads and stores of one register (ARMv7-M 2010, A5.2.4, A5.3.7 to A5.3.10). What is in the SRAM is reached
// here, all else by Processor::readElsewhere() and writeElsewhere().
#include <cstring>
#include <type_traits>

#include "hil/source/cortex_m_child/decoder.h"
#include "hil/source/cortex_m_child/dispatch.h"

namespace kerfbench::cortex_m_child {
namespace {

/// Base and number; base and shifted register; base that takes the sum before or after; beside the code.
enum class Address : std::uint8_t { kNumber, kRegister, kBefore, kAfter, kLiteral };
enum class Target : std::uint8_t { kRegister, kStack, kPc };
constexpr unsigned kAddresses = 5;

template <Address kAddress>
std::uint32_t addressOf(const Processor& p, const Operation* at) {
  if constexpr (kAddress == Address::kLiteral) return at->number;
  if constexpr (kAddress == Address::kAfter) return p.r[at->n];
  if constexpr (kAddress == Address::kRegister) return p.r[at->n] + (p.r[at->m] << at->shift);
  return p.r[at->n] + at->number;
}

template <Address kAddress>
void writeBack(Processor& p, const Operation* at) {
  if constexpr (kAddress != Address::kBefore && kAddress != Address::kAfter) return;
  const std::uint32_t sum = p.r[at->n] + at->number;
  p.r[at->n] = at->n == kSp ? sum & ~3U : sum;
}

template <typename Value>
constexpr std::uint32_t extended(Value value) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(value));
}

template <typename Value>
bool isAlignedInSram(const Processor& p, std::uint32_t offset) {
  return offset < p.sram_bytes && (offset & (sizeof(Value) - 1)) == 0;
}

template <Target kTarget>
void fill(Processor& p, const Operation* at, std::uint32_t value) {
  p.r[at->d] = kTarget == Target::kStack ? value & ~3U : value;
}

template <typename Value, Address kAddress, Target kTarget>
Stop loadElsewhere(Processor& p, Operation* at, Cycle now) {
  if constexpr (kAddress == Address::kLiteral) now += p.wait_states;
  p.present.cycle = now;
  const auto value = p.readElsewhere(at, addressOf<kAddress>(p, at), sizeof(Value));
  now = p.present.cycle;
  if (!value) return p.stopAt(at, now, p.failure);
  writeBack<kAddress>(p, at);
  if constexpr (kTarget == Target::kPc) {
    p.pc = *value;
    KERFBENCH_TAIL return jumpToPc(p, at, now);
  }
  fill<kTarget>(p, at, extended(static_cast<Value>(*value)));
  KERFBENCH_TAIL return nextAfterLoad(p, at, now);
}

template <typename Value, Address kAddress, Target kTarget>
Stop load(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t offset = addressOf<kAddress>(p, at) - kSramBase;
  if (kTarget == Target::kPc || kAddress == Address::kLiteral || !isAlignedInSram<Value>(p, offset))
      [[unlikely]]
    KERFBENCH_TAIL return loadElsewhere<Value, kAddress, kTarget>(p, at, now);
  Value value{};
  std::memcpy(&value, p.sram + offset, sizeof value);
  writeBack<kAddress>(p, at);
  fill<kTarget>(p, at, extended(value));
  KERFBENCH_TAIL return nextAfterLoad(p, at, now);
}

template <typename Value, Address kAddress>
Stop storeElsewhere(Processor& p, Operation* at, Cycle now) {
  p.present.cycle = now;
  const bool is_done =
      p.writeElsewhere(at, addressOf<kAddress>(p, at), sizeof(Value), static_cast<Value>(p.r[at->d]));
  now = p.present.cycle;
  if (!is_done) return p.stopAt(at, now, p.failure);
  writeBack<kAddress>(p, at);
  KERFBENCH_TAIL return next(p, at, now);
}

template <typename Value, Address kAddress>
Stop store(Processor& p, Operation* at, Cycle now) {
  const std::uint32_t offset = addressOf<kAddress>(p, at) - kSramBase;
  const bool is_code = offset - p.sram_code < p.sram_code_bytes;
  if (!isAlignedInSram<Value>(p, offset) || is_code) [[unlikely]]
    KERFBENCH_TAIL return storeElsewhere<Value, kAddress>(p, at, now);
  const auto value = static_cast<Value>(p.r[at->d]);
  std::memcpy(p.sram + offset, &value, sizeof value);
  p.has_effect = true;
  writeBack<kAddress>(p, at);
  KERFBENCH_TAIL return next(p, at, now);
}

/// PLD and PLI ask for memory before it is needed; the Cortex-M3 does nothing about it.
Stop preload(Processor& p, Operation* at, Cycle now) { KERFBENCH_TAIL return next(p, at, now); }

template <typename Value, Target kTarget = Target::kRegister>
constexpr std::array<Handler, kAddresses> loads() {
  return {&load<Value, Address::kNumber, kTarget>, &load<Value, Address::kRegister, kTarget>,
          &load<Value, Address::kBefore, kTarget>, &load<Value, Address::kAfter, kTarget>,
          &load<Value, Address::kLiteral, kTarget>};
}

template <typename Value>
constexpr std::array<Handler, kAddresses - 1> stores() {
  return {&store<Value, Address::kNumber>, &store<Value, Address::kRegister>, &store<Value, Address::kBefore>,
          &store<Value, Address::kAfter>};
}

constexpr unsigned kByte = 0, kHalfWord = 1, kWord = 2;
/// Loads by size, with those of signed bytes and half-words behind.
constexpr std::array kLoads{loads<std::uint8_t>(), loads<std::uint16_t>(), loads<std::uint32_t>(),
                            loads<std::int8_t>(), loads<std::int16_t>()};
constexpr auto kStackLoads = loads<std::uint32_t, Target::kStack>();
constexpr auto kPcLoads = loads<std::uint32_t, Target::kPc>();
constexpr std::array kStores{stores<std::uint8_t>(), stores<std::uint16_t>(), stores<std::uint32_t>()};

Handler loadOf(unsigned size, bool is_signed, Address address, unsigned target) {
  const auto place = static_cast<std::size_t>(address);
  if (size == kWord && target == kSp) return kStackLoads.at(place);
  if (size == kWord && target == kPc) return kPcLoads.at(place);
  return kLoads.at(is_signed ? size + 3 : size).at(place);
}

Handler storeOf(unsigned size, Address address) {
  return kStores.at(size).at(static_cast<std::size_t>(address));
}

template <unsigned kSize, bool kLoads, bool kSigned = false>
void setAccess(Operation& op, Address address) {
  op.execute = kLoads ? loadOf(kSize, kSigned, address, op.d) : storeOf(kSize, address);
}

template <unsigned kSize, bool kLoads, bool kSigned = false>
bool buildByRegister16(const Encoding& e, Operation& op) {
  op.d = e.reg('t');
  op.n = e.reg('n');
  op.m = e.reg('m');
  setAccess<kSize, kLoads, kSigned>(op, Address::kRegister);
  return true;
}

template <unsigned kSize, bool kLoads>
bool buildByNumber16(const Encoding& e, Operation& op) {
  op.d = e.reg('t');
  op.n = e.reg('n');
  op.number = e['i'] << kSize;
  setAccess<kSize, kLoads>(op, Address::kNumber);
  return true;
}

template <bool kLoads>
bool buildByStack16(const Encoding& e, Operation& op) {
  op.d = e.reg('t');
  op.n = kSp;
  op.number = 4 * e['i'];
  setAccess<kWord, kLoads>(op, Address::kNumber);
  return true;
}

bool buildLiteral16(const Encoding& e, Operation& op) {
  op.d = e.reg('t');
  op.number = e.alignedPc() + 4 * e['i'];
  setAccess<kWord, true>(op, Address::kLiteral);
  return true;
}

/// What wide loads and stores have in common: the rules about SP and PC, and hints that load nothing.
bool setWide(const Encoding& e, Operation& op, bool is_load, Address address) {
  const std::uint32_t size = e['s'];
  const bool is_signed = is_load && e['S'] != 0;
  op.d = e.reg('t');
  const bool has_base = address != Address::kLiteral;
  const bool writes_back = address == Address::kBefore || address == Address::kAfter;
  if (size > kWord || (size == kWord && is_signed)) return false;
  if (writes_back && op.n == op.d) return false;
  if (address == Address::kRegister && isSpOrPc(op.m)) return false;
  if (!is_load) {
    op.execute = storeOf(size, address);
    return op.n != kPc && op.d != kPc && (op.d != kSp || size == kWord);
  }
  if (op.d == kPc && size != kWord) {
    op.execute = &preload;
    return !writes_back;
  }
  op.execute = loadOf(size, is_signed, address, op.d);
  if (op.d == kPc) return e.mayBranch() && (!has_base || op.n != kPc);
  return (op.d != kSp || size == kWord) && (!has_base || op.n != kPc);
}

template <bool kLoads>
bool buildByNumber(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.number = e['i'];
  return setWide(e, op, kLoads, Address::kNumber);
}

bool buildLiteral(const Encoding& e, Operation& op) {
  op.n = kPc;
  op.number = e['U'] != 0 ? e.alignedPc() + e['i'] : e.alignedPc() - e['i'];
  return setWide(e, op, true, Address::kLiteral);
}

/// P, U and W: before or after, up or down, whether the base changes. All as before but T: the unprivileged
/// ones.
template <bool kLoads>
bool buildIndexed(const Encoding& e, Operation& op) {
  const bool before = e['p'] != 0;
  const bool up = e['u'] != 0;
  const bool writes_back = e['w'] != 0;
  if (!before && !writes_back) return false;
  op.n = e.reg('n');
  op.number = up ? e['i'] : 0U - e['i'];
  const bool is_unprivileged = before && up && !writes_back;
  if (is_unprivileged && isSpOrPc(e['t'])) return false;
  const Address address = !writes_back ? Address::kNumber : before ? Address::kBefore : Address::kAfter;
  return setWide(e, op, kLoads, address);
}

template <bool kLoads>
bool buildByRegister(const Encoding& e, Operation& op) {
  op.n = e.reg('n');
  op.m = e.reg('m');
  op.shift = e.reg('i');
  return setWide(e, op, kLoads, Address::kRegister);
}

constexpr EncodingRow kRows[] = {
    {"01001 ttt iiiiiiii", buildLiteral16},
    {"0101 000 mmm nnn ttt", buildByRegister16<kWord, false>},
    {"0101 001 mmm nnn ttt", buildByRegister16<kHalfWord, false>},
    {"0101 010 mmm nnn ttt", buildByRegister16<kByte, false>},
    {"0101 011 mmm nnn ttt", buildByRegister16<kByte, true, true>},
    {"0101 100 mmm nnn ttt", buildByRegister16<kWord, true>},
    {"0101 101 mmm nnn ttt", buildByRegister16<kHalfWord, true>},
    {"0101 110 mmm nnn ttt", buildByRegister16<kByte, true>},
    {"0101 111 mmm nnn ttt", buildByRegister16<kHalfWord, true, true>},
    {"01100 iiiii nnn ttt", buildByNumber16<kWord, false>},
    {"01101 iiiii nnn ttt", buildByNumber16<kWord, true>},
    {"01110 iiiii nnn ttt", buildByNumber16<kByte, false>},
    {"01111 iiiii nnn ttt", buildByNumber16<kByte, true>},
    {"10000 iiiii nnn ttt", buildByNumber16<kHalfWord, false>},
    {"10001 iiiii nnn ttt", buildByNumber16<kHalfWord, true>},
    {"10010 ttt iiiiiiii", buildByStack16<false>},
    {"10011 ttt iiiiiiii", buildByStack16<true>},
    {"1111100 S U ss 1 1111 tttt iiiiiiiiiiii", buildLiteral},
    {"1111100 S 1 ss 1 nnnn tttt iiiiiiiiiiii", buildByNumber<true>},
    {"1111100 S 0 ss 1 nnnn tttt 1puw iiiiiiii", buildIndexed<true>},
    {"1111100 S 0 ss 1 nnnn tttt 000000 ii mmmm", buildByRegister<true>},
    {"11111000 1 ss 0 nnnn tttt iiiiiiiiiiii", buildByNumber<false>},
    {"11111000 0 ss 0 nnnn tttt 1puw iiiiiiii", buildIndexed<false>},
    {"11111000 0 ss 0 nnnn tttt 000000 ii mmmm", buildByRegister<false>},
};

}  // namespace

std::span<const EncodingRow> singleAccessRows() { return kRows; }

}  // namespace kerfbench::cortex_m_child
