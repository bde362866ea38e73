// SPDX-License-Identifier: GPL-3.0-or-later
// Instructions whose address is in their code: IN, OUT, SBI, CBI, SBIC, SBIS, LDS, STS, each by its page of
// the manual (Atmel 2016). Registers of which nobody wants to hear are read and written as memory is.
#include "hil/source/avr_child/decoder.h"

namespace kerfbench::avr_child {
namespace {

constexpr std::uint32_t kFirstIo = 32;

template <Cycle kCycles, unsigned kWords>
void readWatched(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->d] = p.readRegister(at, now, at->number);
  KERFBENCH_TAIL return begin(p, at + kWords, now + kCycles, data);
}

template <Cycle kCycles, unsigned kWords>
void readIo(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (p.isReadWatched(at->number)) KERFBENCH_TAIL return readWatched<kCycles, kWords>(p, at, now, data);
  data[at->d] = data[at->number];
  KERFBENCH_TAIL return begin(p, at + kWords, now + kCycles, data);
}

template <Cycle kCycles, unsigned kWords>
void writeWatched(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  p.writeRegister(at, now, at->number, data[at->d]);
  KERFBENCH_TAIL return begin(p, at + kWords, now + kCycles, data);
}

template <Cycle kCycles, unsigned kWords>
void writeIo(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  if (p.isWriteWatched(at->number)) KERFBENCH_TAIL return writeWatched<kCycles, kWords>(p, at, now, data);
  data[at->number] = data[at->d];
  KERFBENCH_TAIL return begin(p, at + kWords, now + kCycles, data);
}

void readSreg(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->d] = data[R_SREG] = p.sreg();
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

void writeSreg(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[R_SREG] = data[at->d];
  p.setSreg(data[at->d]);
  KERFBENCH_TAIL return next(p, at, now + 1, data);
}

/// SBI and CBI, which read the register and write it back.
template <bool kSets>
void changeBit(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const std::uint32_t value = p.readRegister(at, now, at->number);
  const std::uint32_t changed = kSets ? value | at->d : value & ~std::uint32_t{at->d};
  p.writeRegister(at, now, at->number, static_cast<std::uint8_t>(changed));
  KERFBENCH_TAIL return next(p, at, now + 2, data);
}

/// SBIC and SBIS: each word that is skipped takes a cycle.
template <bool kWhereSet>
void skipOnIo(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  const bool is_set = (p.readRegister(at, now, at->number) & at->d) != 0;
  const std::int32_t skipped = is_set == kWhereSet ? at->leap : 0;
  KERFBENCH_TAIL return begin(p, at + 1 + skipped, now + 1 + static_cast<Cycle>(skipped), data);
}

void loadRam(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->d] = data[at->number];
  KERFBENCH_TAIL return begin(p, at + 2, now + 2, data);
}

void storeRam(Processor& p, Operation* at, Cycle now, std::uint8_t* data) {
  data[at->number] = data[at->d];
  KERFBENCH_TAIL return begin(p, at + 2, now + 2, data);
}

template <Handler kHandler, Handler kOfSreg>
bool buildIo(const Encoding& e, Operation& op) {
  op.number = static_cast<std::uint16_t>(kFirstIo + e['A']);
  op.execute = op.number == R_SREG ? kOfSreg : kHandler;
  op.d = e.reg('d');
  return true;
}

template <Handler kHandler>
bool buildIoBit(const Encoding& e, Operation& op) {
  op.execute = kHandler;
  op.d = e.mask('b');
  op.number = static_cast<std::uint16_t>(kFirstIo + e['A']);
  op.leap = static_cast<std::int32_t>(wordsBehind(e));
  return true;
}

template <Handler kOfRam, Handler kOfRegisters>
bool buildDirect(const Encoding& e, Operation& op) {
  const std::uint32_t address = e['k'];
  op.execute = e.processor.isRam(address) ? kOfRam : kOfRegisters;
  op.d = e.reg('d');
  op.number = static_cast<std::uint16_t>(address);
  return e.processor.isRam(address) || e.processor.isRegister(address);
}

constexpr EncodingRow kRows[] = {
    {"1011 0AAd dddd AAAA", buildIo<&readIo<1, 1>, &readSreg>},
    {"1011 1AAd dddd AAAA", buildIo<&writeIo<1, 1>, &writeSreg>},
    {"1001 1010 AAAA Abbb", buildIoBit<&changeBit<true>>},
    {"1001 1000 AAAA Abbb", buildIoBit<&changeBit<false>>},
    {"1001 1001 AAAA Abbb", buildIoBit<&skipOnIo<false>>},
    {"1001 1011 AAAA Abbb", buildIoBit<&skipOnIo<true>>},
    {"1001 000d dddd 0000 kkkk kkkk kkkk kkkk", buildDirect<&loadRam, &readIo<2, 2>>},
    {"1001 001d dddd 0000 kkkk kkkk kkkk kkkk", buildDirect<&storeRam, &writeIo<2, 2>>},
};

}  // namespace

std::span<const EncodingRow> registerAccessRows() { return kRows; }

}  // namespace kerfbench::avr_child
