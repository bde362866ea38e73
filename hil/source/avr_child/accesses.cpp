// SPDX-License-Identifier: GPL-3.0-or-later
// Loads and stores by the pointers X, Y and Z, of the stack and of the flash, each by its page of the manual
// (Atmel 2016). Addresses behind the RAM are left to simavr, which says that there is nothing.
#include "hil/source/avr_child/decoder.h"
#include "hil/source/avr_child/words.h"

namespace kerfbench::avr_child {
namespace {

/// What becomes of the pointer.
enum class Step : std::uint8_t { kNone, kAfter, kBefore };

template <Step kStep>
std::uint32_t addressFor(const Operation* at, std::uint32_t pointer) {
  return (kStep == Step::kBefore ? pointer - 1 : pointer + at->number) & 0xFFFFU;
}

template <unsigned kPointer, Step kStep>
void setPointer(std::uint8_t* data, std::uint32_t address) {
  if constexpr (kStep == Step::kNone) return;
  const std::uint32_t value = kStep == Step::kAfter ? address + 1 : address;
  setWordIn(data, kPointer, value);
}

/// Loads from a register, or from where there is nothing.
template <unsigned kPointer, Step kStep>
void loadElsewhere(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t address = addressFor<kStep>(at, pairIn(data, kPointer));
  if (!p.isRegister(address)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  const std::uint8_t value = p.readRegister(at, now, address);
  setPointer<kPointer, kStep>(data, address);
  data[at->d] = value;
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

template <unsigned kPointer, Step kStep>
void load(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t address = addressFor<kStep>(at, pairIn(data, kPointer));
  if (!p.isRam(address)) [[unlikely]]
    KERFBENCH_TAIL return loadElsewhere<kPointer, kStep>(p, at, now, data);
  setPointer<kPointer, kStep>(data, address);
  data[at->d] = data[address];
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

template <unsigned kPointer, Step kStep>
void storeElsewhere(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t address = addressFor<kStep>(at, pairIn(data, kPointer));
  if (!p.isRegister(address)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  const std::uint8_t value = data[at->d];
  p.writeRegister(at, now, address, value);
  setPointer<kPointer, kStep>(data, address);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

template <unsigned kPointer, Step kStep>
void store(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t address = addressFor<kStep>(at, pairIn(data, kPointer));
  if (!p.isRam(address)) [[unlikely]]
    KERFBENCH_TAIL return storeElsewhere<kPointer, kStep>(p, at, now, data);
  data[address] = data[at->d];
  setPointer<kPointer, kStep>(data, address);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

void push(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t sp = stackPointer(data);
  if (!p.isRam(sp)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  data[sp] = data[at->d];
  setStackPointer(data, sp - 1);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

void pop(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t sp = stackPointer(data) + 1;
  if (!p.isRam(sp)) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  data[at->d] = data[sp];
  setStackPointer(data, sp);
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

/// LPM and ELPM, whose address RAMPZ makes longer.
template <bool kExtended, bool kIncrements>
void loadFromFlash(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  std::uint32_t z = pairIn(data, R_ZL);
  if constexpr (kExtended) z |= std::uint32_t{data[p.avr->rampz]} << 16U;
  if (z >= p.flash_bytes) KERFBENCH_TAIL return elsewhere(p, at, now, data);
  const std::uint8_t value = p.avr->flash[z];
  if constexpr (kIncrements) {
    ++z;
    if constexpr (kExtended) data[p.avr->rampz] = static_cast<std::uint8_t>(z >> 16U);
    setWordIn(data, R_ZL, z);
  }
  data[at->d] = value;
  KERFBENCH_TAIL return next(p, at, now + 3, data);
}

/// A register that is pointer and operand of one instruction is "undefined" in the manual, and simavr's
/// matter.
template <Handler kHandler, unsigned kPointer>
bool buildStepped(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.reg('d');
  return op.d != kPointer && op.d != kPointer + 1;
}

template <Handler kHandler>
bool buildRegister(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.reg('d');
  return true;
}

template <Handler kHandler>
bool buildDisplaced(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.reg('d');
  op.number = static_cast<std::uint16_t>(e['q']);
  return true;
}

template <bool kExtended, bool kIncrements>
bool buildFromFlash(const Encoding& e, Operation& op) {
  op.execute = &loadFromFlash<kExtended, kIncrements>;
  op.d = e.reg('d');
  const bool is_pointer = kIncrements && op.d >= R_ZL;
  return !is_pointer && (!kExtended || e.processor.avr->rampz != 0);
}

template <unsigned kPointer, Step kStep>
constexpr auto kStepped = &buildStepped<&load<kPointer, kStep>, kPointer>;
template <unsigned kPointer, Step kStep>
constexpr auto kStoredStepped = &buildStepped<&store<kPointer, kStep>, kPointer>;

constexpr EncodingRow kRows[] = {
    {"1001 000d dddd 1100", buildRegister<&load<R_XL, Step::kNone>>},
    {"1001 000d dddd 1101", kStepped<R_XL, Step::kAfter>},
    {"1001 000d dddd 1110", kStepped<R_XL, Step::kBefore>},
    {"10q0 qq0d dddd 1qqq", buildDisplaced<&load<R_YL, Step::kNone>>},
    {"1001 000d dddd 1001", kStepped<R_YL, Step::kAfter>},
    {"1001 000d dddd 1010", kStepped<R_YL, Step::kBefore>},
    {"10q0 qq0d dddd 0qqq", buildDisplaced<&load<R_ZL, Step::kNone>>},
    {"1001 000d dddd 0001", kStepped<R_ZL, Step::kAfter>},
    {"1001 000d dddd 0010", kStepped<R_ZL, Step::kBefore>},
    {"1001 001d dddd 1100", buildRegister<&store<R_XL, Step::kNone>>},
    {"1001 001d dddd 1101", kStoredStepped<R_XL, Step::kAfter>},
    {"1001 001d dddd 1110", kStoredStepped<R_XL, Step::kBefore>},
    {"10q0 qq1d dddd 1qqq", buildDisplaced<&store<R_YL, Step::kNone>>},
    {"1001 001d dddd 1001", kStoredStepped<R_YL, Step::kAfter>},
    {"1001 001d dddd 1010", kStoredStepped<R_YL, Step::kBefore>},
    {"10q0 qq1d dddd 0qqq", buildDisplaced<&store<R_ZL, Step::kNone>>},
    {"1001 001d dddd 0001", kStoredStepped<R_ZL, Step::kAfter>},
    {"1001 001d dddd 0010", kStoredStepped<R_ZL, Step::kBefore>},
    {"1001 001d dddd 1111", buildRegister<&push>},
    {"1001 000d dddd 1111", buildRegister<&pop>},
    {"1001 0101 1100 1000", buildFromFlash<false, false>},
    {"1001 000d dddd 0100", buildFromFlash<false, false>},
    {"1001 000d dddd 0101", buildFromFlash<false, true>},
    {"1001 0101 1101 1000", buildFromFlash<true, false>},
    {"1001 000d dddd 0110", buildFromFlash<true, false>},
    {"1001 000d dddd 0111", buildFromFlash<true, true>},
};

}  // namespace

std::span<const EncodingRow> accessRows() { return kRows; }

}  // namespace kerfbench::avr_child
