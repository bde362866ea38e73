// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace kerfbench::mcs51_child {

/// Clocks of the oscillator since power came.
using Tick = std::uint64_t;
inline constexpr Tick kNever = std::numeric_limits<Tick>::max();

/// Addresses of the special function registers (Intel 1994, chapter 1; for kAuxr … of the STC15, STC 2015).
enum SfrAddress : std::uint8_t {
  kP0 = 0x80,
  kSp = 0x81,
  kDpl = 0x82,
  kDph = 0x83,
  kDp1l = 0x84,
  kDp1h = 0x85,
  kPcon = 0x87,
  kTcon = 0x88,
  kTmod = 0x89,
  kTl0 = 0x8A,
  kTl1 = 0x8B,
  kTh0 = 0x8C,
  kTh1 = 0x8D,
  kAuxr = 0x8E,
  kClockOut = 0x8F,  ///< INT_CLKO of the STC15.
  kP1 = 0x90,
  kScon = 0x98,
  kSbuf = 0x99,
  kP2 = 0xA0,
  kAuxr1 = 0xA2,  ///< DPS in bit 0; P_SW1 of the STC15.
  kWdtrst = 0xA6,
  kIe = 0xA8,
  kIe2 = 0xAF,
  kP3 = 0xB0,
  kIp = 0xB8,
  kT2con = 0xC8,
  kT2mod = 0xC9,
  kRcap2l = 0xCA,
  kRcap2h = 0xCB,
  kTl2 = 0xCC,
  kTh2 = 0xCD,
  kPsw = 0xD0,
  kStcT2h = 0xD6,
  kStcT2l = 0xD7,
  kAcc = 0xE0,
  kB = 0xF0,
};

/// Bits of registers, as masks.
inline constexpr std::uint8_t kCarry = 0x80, kAuxiliaryCarry = 0x40, kBank = 0x18, kOverflow = 0x04,
                              kParity = 0x01;                                 // PSW
inline constexpr std::uint8_t kSmod = 0x80, kPowerDown = 0x02, kIdle = 0x01;  // PCON
inline constexpr std::uint8_t kSm2 = 0x20, kRen = 0x10, kTb8 = 0x08, kRb8 = 0x04, kTi = 0x02,
                              kRi = 0x01;  // SCON
inline constexpr std::uint8_t kTf2 = 0x80, kExf2 = 0x40, kRclk = 0x20, kTclk = 0x10, kExen2 = 0x08,
                              kTr2 = 0x04, kCt2 = 0x02, kCapture2 = 0x01;  // T2CON
inline constexpr std::uint8_t kT2oe = 0x02, kDcen = 0x01;                  // T2MOD
inline constexpr std::uint8_t kEa = 0x80;                                  // IE

/// What the special function registers hold.
struct Sfrs {
  std::array<std::uint8_t, 128> bytes{};
  /// `address` is in [0x80, 0xFF].
  std::uint8_t& operator[](std::uint8_t address) { return bytes[address & 0x7FU]; }
  std::uint8_t operator[](std::uint8_t address) const { return bytes[address & 0x7FU]; }
  void set(std::uint8_t address, std::uint8_t mask, bool on) {
    auto& byte = (*this)[address];
    byte = static_cast<std::uint8_t>(on ? byte | mask : byte & ~mask);
  }
};

}  // namespace kerfbench::mcs51_child
