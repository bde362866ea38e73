// SPDX-License-Identifier: GPL-3.0-or-later
// Flags and single bits, each by its page of the manual (Atmel 2016).
#include <avr_watchdog.h>

#include "hil/source/avr_child/decoder.h"
#include "hil/source/avr_child/flags.h"

namespace kerfbench::avr_child {
namespace {

/// BSET and BCLR of a flag that is seldom written by itself.
template <bool kSets>
void setFlag(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t sreg = p.sreg();
  p.setSreg(static_cast<std::uint8_t>(kSets ? sreg | at->d : sreg & ~std::uint32_t{at->d}));
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

template <bool kSets>
void setTransfer(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.avr->sreg[S_T] = kSets;
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

template <bool kSets>
void setCarryFlag(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  setCarry(p, kSets);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

/// SEI and CLI.
template <bool kSets>
void setInterruptFlag(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.setInterrupts(kSets);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

/// BST and BLD.
void storeBit(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.avr->sreg[S_T] = (data[at->d] & at->number) != 0;
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void loadBit(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t others = data[at->d] & ~std::uint32_t{at->number};
  data[at->d] = static_cast<std::uint8_t>(p.avr->sreg[S_T] != 0 ? others | at->number : others);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void doNothing(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void resetWatchdog(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.place(at, now);
  avr_ioctl(p.avr, static_cast<std::uint32_t>(AVR_IOCTL_WATCHDOG_RESET), nullptr);
  p.watch();
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

template <bool kSets>
bool buildSetFlag(const Encoding& e, Operation& op) {
  op.d = e.mask('s');
  op.execute = &setFlag<kSets>;
  if (e['s'] == S_T) op.execute = &setTransfer<kSets>;
  if (e['s'] == S_C) op.execute = &setCarryFlag<kSets>;
  if (e['s'] == S_I) op.execute = &setInterruptFlag<kSets>;
  return true;
}

template <Handler kHandler>
bool buildBit(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.reg('d');
  op.number = e.mask('b');
  return true;
}

template <Handler kHandler>
bool buildAlone(const Encoding& /*e*/, Operation& op) {
  op.execute = kHandler;
  return true;
}

constexpr EncodingRow kRows[] = {
    {"1001 0100 0sss 1000", buildSetFlag<true>},     {"1001 0100 1sss 1000", buildSetFlag<false>},
    {"1111 101d dddd 0bbb", buildBit<&storeBit>},    {"1111 100d dddd 0bbb", buildBit<&loadBit>},
    {"0000 0000 0000 0000", buildAlone<&doNothing>}, {"1001 0101 1010 1000", buildAlone<&resetWatchdog>},
};

}  // namespace

std::span<const EncodingRow> bitRows() { return kRows; }

}  // namespace kerfbench::avr_child
