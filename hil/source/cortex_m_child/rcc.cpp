// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/rcc.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kControl = 0x00, kConfiguration = 0x04, kResetApb2 = 0x0C, kResetApb1 = 0x10,
                        kEnableAhb = 0x14, kEnableApb2 = 0x18, kEnableApb1 = 0x1C, kBackup = 0x20,
                        kStatus = 0x24;
constexpr std::uint32_t kHsiOn = 1, kHseOn = 1U << 16, kPllOn = 1U << 24;
constexpr std::uint32_t kFromHse = 1U << 16, kHalfHse = 1U << 17, kUsbUndivided = 1U << 22;

/// Dividers of 2 and more are coded from `half` on.
unsigned prescaler(std::uint32_t code, unsigned half) { return code < half ? 1U : 2U << (code - half); }

}  // namespace

void Rcc::reset() {
  control_ = 0x83;
  configuration_ = 0;
  enabled_ = {0x14, 0, 0};
  status_ &= 0xFC000000U;
}

std::uint32_t Rcc::control() const {
  return control_ | ((control_ & kHsiOn) != 0 ? 1U << 1 : 0U) | ((control_ & kHseOn) != 0 ? 1U << 17 : 0U) |
         ((control_ & kPllOn) != 0 ? 1U << 25 : 0U);
}

std::uint64_t Rcc::pllHz() const {
  const unsigned factor = (configuration_ >> 18 & 0xFU) + 2U;
  const std::uint64_t source = (configuration_ & kFromHse) == 0   ? kHsi_hz / 2
                               : (configuration_ & kHalfHse) != 0 ? kHse_hz / 2
                                                                  : kHse_hz;
  return source * (factor > 16U ? 16U : factor);
}

std::uint64_t Rcc::systemHz() const {
  switch (configuration_ & 3U) {
    case 1:
      return (control_ & kHseOn) != 0 ? kHse_hz : kHsi_hz;
    case 2:
      return (control_ & kPllOn) != 0 ? pllHz() : kHsi_hz;
    default:
      return kHsi_hz;
  }
}

std::uint64_t Rcc::coreHz() const {
  // HPRE: 1000 is 2, … 1011 is 16, and 1100 is 64, … 1111 is 512.
  const std::uint32_t code = configuration_ >> 4 & 0xFU;
  return systemHz() / (code < 12U ? prescaler(code, 8) : 64U << (code - 12U));
}

unsigned Rcc::divider(ClockBus bus) const {
  if (bus == ClockBus::kApb1) return prescaler(configuration_ >> 8 & 7U, 4);
  if (bus == ClockBus::kApb2) return prescaler(configuration_ >> 11 & 7U, 4);
  return 1;
}

unsigned Rcc::timerDivider(ClockBus bus) const {
  const unsigned bus_divider = divider(bus);
  return bus_divider == 1 ? 1U : bus_divider / 2U;
}

std::uint64_t Rcc::usbHz() const {
  if ((control_ & kPllOn) == 0) return 0;
  return (configuration_ & kUsbUndivided) != 0 ? pllHz() : pllHz() * 2 / 3;
}

bool Rcc::isOn(ClockBus bus, unsigned bit) const {
  return bus == ClockBus::kAlways || (enabled_[static_cast<std::size_t>(bus)] >> bit & 1U) != 0;
}

std::string Rcc::clockInWords() const {
  static constexpr const char* kSources[] = {"HSI", "HSE", "PLL", "HSI"};
  return std::to_string(coreHz()) + " Hz from " + kSources[configuration_ & 3U];
}

std::uint32_t Rcc::read(std::uint32_t offset) {
  switch (offset) {
    case kControl:
      return control();
    case kConfiguration:
      return (configuration_ & ~0xCU) | (configuration_ & 3U) << 2;
    case kEnableAhb:
      return enabled_[0];
    case kEnableApb1:
      return enabled_[1];
    case kEnableApb2:
      return enabled_[2];
    case kBackup:
      return backup_ | ((backup_ & 1U) << 1);
    case kStatus:
      return status_ | ((status_ & 1U) << 1);
    default:
      return 0;
  }
}

void Rcc::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kControl:
      control_ = value & 0x010D00F9U;
      break;
    case kConfiguration:
      configuration_ = value & 0x077FFFF3U;
      break;
    case kResetApb2:
      if (on_reset) on_reset(ClockBus::kApb2, value);
      break;
    case kResetApb1:
      if (on_reset) on_reset(ClockBus::kApb1, value);
      break;
    case kEnableAhb:
      enabled_[0] = value;
      break;
    case kEnableApb1:
      enabled_[1] = value;
      break;
    case kEnableApb2:
      enabled_[2] = value;
      break;
    case kBackup:
      backup_ = value & 0x00018305U;
      break;
    case kStatus:
      if ((value >> 24 & 1U) != 0) status_ = 0;
      status_ = (status_ & ~1U) | (value & 1U);
      break;
    default:
      break;
  }
}

}  // namespace kerfbench::cortex_m_child
