// SPDX-License-Identifier: Apache-2.0
// What reads and writes of special function registers do.
#include "hil/source/mcs51_child/chip.h"

namespace kerfbench::mcs51_child {
namespace {

constexpr Tick kWatchdogCycles = 16383;  // Atmel 2008: 14 bits, reset as it comes to 3FFF.

}  // namespace

int Chip::portAt(std::uint8_t address) const {
  switch (address) {
    case kP0:
      return 0;
    case kP1:
      return 1;
    case kP2:
      return 2;
    case kP3:
      return 3;
    case 0xC0:
      return part_.is_stc15 ? 4 : -1;
    case 0xC8:
      return part_.is_stc15 ? 5 : -1;
    default:
      return -1;
  }
}

std::uint8_t Chip::readSfr(std::uint8_t address, bool is_latch) {
  const int port = portAt(address);
  if (port >= 0) {
    const auto index = static_cast<unsigned>(port);
    return is_latch ? ports_.latch(index) : ports_.pins(index);
  }
  const Tick fetched = cpu_.fetched();
  advance(fetched);
  switch (address) {
    case kTl0:
    case kTl1:
    case kTh0:
    case kTh1:
      timers_.advance(fetched);
      return timers_.read(address);
    case kTl2:
    case kTh2:
      if (!part_.has_timer2) return sfrs_[address];
      timers_.advance(fetched);
      return timers_.read(address);
    case kStcT2l:
    case kStcT2h:
      if (!part_.is_stc15) return sfrs_[address];
      timers_.advance(fetched);
      return timers_.read(address);
    case kSbuf:
      return uart_.received();
    default:
      return sfrs_[address];
  }
}

void Chip::writeSfr(std::uint8_t address, std::uint8_t value) {
  advance(cpu_.ends());
  if (const int port = portAt(address); port >= 0) {
    writePort(static_cast<unsigned>(port), value);
  } else {
    writeRegister(address, value);
  }
  // What comes of it must not be passed over: an interrupt, a flood.
  cpu_.attend(interrupts_.hasPending() || ports_.isFlooded() ? 0 : next_);
}

void Chip::writeRegister(std::uint8_t address, std::uint8_t value) {
  if (part_.is_stc15 && writeStcPortMode(address, value)) {
    sfrs_[address] = value;
  } else {
    timers_.advance(cpu_.ends());
    writeControl(address, value);
  }
  refreshNext();
}

void Chip::writeSfrBit(std::uint8_t address, std::uint8_t mask, bool on) {
  advance(cpu_.ends());
  const int port = portAt(address);
  const unsigned old = port >= 0 ? ports_.latch(static_cast<unsigned>(port)) : sfrs_[address];
  writeSfr(address, static_cast<std::uint8_t>(on ? old | mask : old & ~unsigned{mask}));
}

void Chip::writePort(unsigned port, std::uint8_t value) {
  ports_.setLatch(port, value, cpu_.ends());
  if (port < 4) sfrs_[static_cast<std::uint8_t>(kP0 + 0x10U * port)] = value;
  if (port == 1 || port == 3) pinsChanged(cpu_.ends());
}

bool Chip::writeStcPortMode(std::uint8_t address, std::uint8_t value) {
  constexpr std::uint8_t kM1[] = {0x93, 0x91, 0x95, 0xB1, 0xB3, 0xC9};
  constexpr std::uint8_t kM0[] = {0x94, 0x92, 0x96, 0xB2, 0xB4, 0xCA};
  for (unsigned port = 0; port < Ports::kPorts; ++port) {
    if (address != kM1[port] && address != kM0[port]) continue;
    ports_.setMode(port, address == kM1[port], value, cpu_.ends());
    pinsChanged(cpu_.ends());
    return true;
  }
  return false;
}

/// Registers of flags: what is polled at the end of this instruction is what they were before it.
void Chip::writeFlags(std::uint8_t address, std::uint8_t value) {
  interrupts_.hold(cpu_.ends());
  sfrs_[address] = value;
  if (address == kTcon) followLevels(cpu_.ends());
  interrupts_.written(cpu_.ends());
  timers_.configure(cpu_.ends());
  if (address == kScon) uart_.configure(cpu_.ends());
}

void Chip::writeControl(std::uint8_t address, std::uint8_t value) {
  switch (address) {
    case kTcon:
    case kScon:
    case kT2con:
      writeFlags(address, value);
      break;
    case kIe:
    case kIp:
    case kIe2:
      sfrs_[address] = value;
      interrupts_.inhibit();
      interrupts_.refresh();
      break;
    case kSbuf:
      uart_.send(value, cpu_.ends());
      break;
    case kPcon:
      writePowerControl(value);
      break;
    case kWdtrst:
      feedWatchdog(value);
      break;
    case kT2mod:
      if (part_.has_clock_out && (value & kDcen) != 0) {
        cpu_.setFault("timer 2 is told to count down (DCEN), which is not emulated,");
      }
      [[fallthrough]];
    case kTmod:
    case kAuxr:
    case kRcap2l:
    case kRcap2h:
      sfrs_[address] = value;
      timers_.configure(cpu_.ends());
      break;
    default:
      sfrs_[address] = value;
      timers_.write(address, value);
  }
}

void Chip::writePowerControl(std::uint8_t value) {
  sfrs_[kPcon] = value;
  if ((value & (kIdle | kPowerDown)) != 0) cpu_.attend(0);
  if ((value & kPowerDown) == 0) return;
  timers_.setStopped(true, cpu_.ends());
  stopped_at_ = cpu_.ends();
}

/// 1E and then E1 start the watchdog, and start it anew.
void Chip::feedWatchdog(std::uint8_t value) {
  if (part_.has_watchdog && watchdog_key_ == 0x1E && value == 0xE1) {
    watchdog_ = cpu_.ends() + kWatchdogCycles * part_.cycle();
  }
  watchdog_key_ = value;
}

void Chip::pokeSfr(std::uint8_t address, std::uint8_t value) {
  cpu_.setEnd(now_);
  writeSfr(address, value);
}

}  // namespace kerfbench::mcs51_child
