// SPDX-License-Identifier: GPL-3.0-or-later
// Branches, calls, returns and skips, each by its page of the manual (Atmel 2016). What leads out of the
// flash ends the run, and simavr says so.
#include "hil/source/avr_child/decoder.h"
#include "hil/source/avr_child/words.h"

namespace kerfbench::avr_child {
namespace {

/// Words of an address on the stack: a controller of more than 128 KiB has three bytes, and takes a cycle
/// more.
enum class Addresses : unsigned { kShort = 2, kLong = 3 };

template <Addresses kSize>
constexpr unsigned kBytes = static_cast<unsigned>(kSize);
template <Addresses kSize>
constexpr Cycle kLonger = kSize == Addresses::kLong ? 1 : 0;

template <Addresses kSize>
bool isStack(const Processor& p, std::uint32_t first) {
  return p.isRam(first) && p.isRam(first + kBytes<kSize> - 1);
}

/// False where the stack is not in the RAM; nothing is done then.
template <Addresses kSize>
bool pushAddress(const Processor& p, std::uint8_t* data, std::uint32_t word) {
  const std::uint32_t sp = stackPointer(data);
  if (!isStack<kSize>(p, sp - kBytes<kSize> + 1)) return false;
  for (unsigned i = 0; i < kBytes<kSize>; ++i) data[sp - i] = static_cast<std::uint8_t>(word >> 8U * i);
  setStackPointer(data, sp - kBytes<kSize>);
  return true;
}

void jump(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  KERFBENCH_TAIL return begin(p, at + at->leap, now + at->number, data);
}

/// RCALL of three cycles, CALL of four, for addresses of two bytes; `number` is the instruction's words.
template <Addresses kSize>
void call(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (!pushAddress<kSize>(p, data, p.pcOf(at) / 2 + at->number))
    KERFBENCH_TAIL return elsewhere(p, at, now, data);
  KERFBENCH_TAIL return begin(p, at + at->leap, now + 2 + at->number + kLonger<kSize>, data);
}

/// IJMP; with EIND EIJMP.
template <bool kExtended>
std::uint32_t pointedWord(const Processor& p, const std::uint8_t* data) {
  const std::uint32_t z = pairIn(data, R_ZL);
  return kExtended ? z | std::uint32_t{data[p.avr->eind]} << 16U : z;
}

template <bool kExtended>
void jumpByPointer(Processor& p, Operation* /*at*/, Cycle now, std::uint8_t* data) {
  const std::uint32_t word = pointedWord<kExtended>(p, data);
  if (!p.isCode(word)) return p.leaveFlash(word, now + 2);
  KERFBENCH_TAIL return begin(p, &p.code[word], now + 2, data);
}

template <Addresses kSize, bool kExtended>
void callByPointer(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (!pushAddress<kSize>(p, data, p.pcOf(at) / 2 + 1)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  const Cycle then = now + (kExtended ? 4 : 3 + kLonger<kSize>);
  const std::uint32_t word = pointedWord<kExtended>(p, data);
  if (!p.isCode(word)) return p.leaveFlash(word, then);
  KERFBENCH_TAIL return begin(p, &p.code[word], then, data);
}

/// RET and RETI.
template <Addresses kSize, bool kFromInterrupt>
void leave(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t sp = stackPointer(data);
  if (!isStack<kSize>(p, sp + 1)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  std::uint32_t word = 0;
  for (unsigned i = 1; i <= kBytes<kSize>; ++i) word = word << 8U | data[sp + i];
  setStackPointer(data, sp + kBytes<kSize>);
  if constexpr (kFromInterrupt) {
    p.place(at, now);
    avr_interrupt_reti(p.avr);
    p.setInterrupts(true);
  }
  const Cycle then = now + 4 + kLonger<kSize>;
  if (!p.isCode(word)) return p.leaveFlash(word, then);
  KERFBENCH_TAIL return begin(p, &p.code[word], then, data);
}

/// Flags by their number in SREG.
template <unsigned kFlag>
bool isSet(const Processor& p) {
  const bool is_negative = (p.negative & 0x80U) != 0;
  if constexpr (kFlag == S_C) return p.carry() != 0;
  if constexpr (kFlag == S_Z) return p.zero == 0;
  if constexpr (kFlag == S_N) return is_negative;
  if constexpr (kFlag == S_V) return (p.overflow >> 8U & 1U) != 0;
  if constexpr (kFlag == S_S) return is_negative != (((p.overflow >> 8U ^ p.overflow >> 16U) & 1U) != 0);
  if constexpr (kFlag == S_H) return (p.carries >> 4U & 1U) != 0;
  return p.avr->sreg[kFlag] != 0;
}

template <unsigned kFlag, bool kWhereSet>
void branch(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (isSet<kFlag>(p) == kWhereSet) KERFBENCH_TAIL return begin(p, at + at->leap, now + 2, data);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

/// CPSE, SBRC and SBRS: each word that is skipped takes a cycle.
void skipIfEqual(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::int32_t skipped = data[at->d] == data[at->r] ? at->leap : 0;
  KERFBENCH_TAIL return begin(p, at + 1 + skipped, now + 1 + static_cast<Cycle>(skipped), data);
}

template <bool kWhereSet>
void skipOnBit(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const bool is_set = (data[at->r] & at->d) != 0;
  const std::int32_t skipped = is_set == kWhereSet ? at->leap : 0;
  KERFBENCH_TAIL return begin(p, at + 1 + skipped, now + 1 + static_cast<Cycle>(skipped), data);
}

bool setTarget(const Encoding& e, Operation& op, std::int64_t word) {
  op.leap = static_cast<std::int32_t>(word - e.pc / 2);
  return word >= 0 && word < e.processor.flash_bytes / 2;
}

bool isLong(const Encoding& e) { return e.processor.avr->address_size > 2; }

template <bool kCalls>
bool buildRelative(const Encoding& e, Operation& op) {
  op.execute = &jump;
  if (kCalls) op.execute = isLong(e) ? &call<Addresses::kLong> : &call<Addresses::kShort>;
  op.number = kCalls ? 1 : 2;
  return setTarget(e, op, std::int64_t{e.pc / 2} + 1 + e.signedField('k', 12));
}

template <bool kCalls>
bool buildAbsolute(const Encoding& e, Operation& op) {
  op.execute = &jump;
  if (kCalls) op.execute = isLong(e) ? &call<Addresses::kLong> : &call<Addresses::kShort>;
  op.number = kCalls ? 2 : 3;
  return setTarget(e, op, e['k']);
}

template <bool kExtended, bool kCalls>
bool buildByPointer(const Encoding& e, Operation& op) {
  op.execute = &jumpByPointer<kExtended>;
  if (kCalls)
    op.execute = isLong(e) ? &callByPointer<Addresses::kLong, kExtended>
                           : &callByPointer<Addresses::kShort, kExtended>;
  return !kExtended || e.processor.avr->eind != 0;
}

template <bool kFromInterrupt>
bool buildLeave(const Encoding& e, Operation& op) {
  op.execute =
      isLong(e) ? &leave<Addresses::kLong, kFromInterrupt> : &leave<Addresses::kShort, kFromInterrupt>;
  return true;
}

template <bool kWhereSet>
bool buildBranch(const Encoding& e, Operation& op) {
  static constexpr Handler kHandlers[] = {
      &branch<S_C, kWhereSet>, &branch<S_Z, kWhereSet>, &branch<S_N, kWhereSet>, &branch<S_V, kWhereSet>,
      &branch<S_S, kWhereSet>, &branch<S_H, kWhereSet>, &branch<S_T, kWhereSet>, &branch<S_I, kWhereSet>};
  op.execute = kHandlers[e['s']];
  return setTarget(e, op, std::int64_t{e.pc / 2} + 1 + e.signedField('k', 7));
}

bool buildSkipIfEqual(const Encoding& e, Operation& op) {
  op.execute = &skipIfEqual;
  op.d = e.reg('d');
  op.r = e.reg('r');
  op.leap = static_cast<std::int32_t>(wordsBehind(e));
  return true;
}

template <bool kWhereSet>
bool buildSkipOnBit(const Encoding& e, Operation& op) {
  op.execute = &skipOnBit<kWhereSet>;
  op.d = e.mask('b');
  op.r = e.reg('r');
  op.leap = static_cast<std::int32_t>(wordsBehind(e));
  return true;
}

constexpr EncodingRow kRows[] = {
    {"1100 kkkk kkkk kkkk", buildRelative<false>},
    {"1101 kkkk kkkk kkkk", buildRelative<true>},
    {"1001 010k kkkk 110k kkkk kkkk kkkk kkkk", buildAbsolute<false>},
    {"1001 010k kkkk 111k kkkk kkkk kkkk kkkk", buildAbsolute<true>},
    {"1001 0100 0000 1001", buildByPointer<false, false>},
    {"1001 0101 0000 1001", buildByPointer<false, true>},
    {"1001 0100 0001 1001", buildByPointer<true, false>},
    {"1001 0101 0001 1001", buildByPointer<true, true>},
    {"1001 0101 0000 1000", buildLeave<false>},
    {"1001 0101 0001 1000", buildLeave<true>},
    {"1111 00kk kkkk ksss", buildBranch<true>},
    {"1111 01kk kkkk ksss", buildBranch<false>},
    {"0001 00rd dddd rrrr", buildSkipIfEqual},
    {"1111 110r rrrr 0bbb", buildSkipOnBit<false>},
    {"1111 111r rrrr 0bbb", buildSkipOnBit<true>},
};

}  // namespace

std::span<const EncodingRow> branchRows() { return kRows; }

}  // namespace kerfbench::avr_child
