// SPDX-License-Identifier: Apache-2.0
// Registers, interrupts, reset and suspend of the USB device; its transactions are in usb_endpoints.cpp.
#include "hil/source/cortex_m_child/usb_device.h"

#include <algorithm>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kControl = 0x40, kStatus = 0x44, kFrame = 0x48, kAddress = 0x4C, kTable = 0x50;
constexpr std::uint32_t kForcedReset = 1U << 0, kPowerDown = 1U << 1, kLowPower = 1U << 2,
                        kForcedSuspend = 1U << 3, kResume = 1U << 4;
constexpr std::uint32_t kMissedFrame = 1U << 8, kStartOfFrame = 1U << 9, kBusReset = 1U << 10,
                        kSuspend = 1U << 11, kWakeUp = 1U << 12, kTransfer = 1U << 15;
constexpr std::uint32_t kFlags = 0x7F00;  // ISTR, those that software clears.
constexpr std::uint32_t kReceived = 1U << 15, kSent = 1U << 7;
constexpr std::uint32_t kToggled = 0x7070;  // EPnR, bits that a written 1 toggles.
constexpr std::uint32_t kPlain = 0x070F;    // EPnR, bits that take what is written.
constexpr std::uint32_t kSetup = 1U << 11;
constexpr unsigned kUsbClockBit = 23, kLowPriorityLine = 20;
constexpr Pin kDataMinus{0, 11}, kDataPlus{0, 12};
constexpr std::uint64_t kUsb_hz = 48'000'000, kLeastBus_hz = 8'000'000;
constexpr double kFrame_s = 1e-3;
constexpr double kLate_s = 10e-6;  // A frame's start counts as missed when it is late by this.

}  // namespace

bool UsbDevice::isAttached() const {
  return around_.rcc.isOn(ClockBus::kApb1, kUsbClockBit) && (control_ & (kForcedReset | kPowerDown)) == 0;
}

/// Interrupt status with what the endpoints add: the lowest that asks comes first.
std::uint32_t UsbDevice::status() const {
  for (unsigned i = 0; i < kEndpoints; ++i) {
    const bool has_received = (endpoints_[i] & kReceived) != 0;
    if (has_received || (endpoints_[i] & kSent) != 0)
      return status_ | kTransfer | (has_received ? 1U << 4 : 0U) | i;
  }
  return status_;
}

std::uint32_t UsbDevice::read(std::uint32_t offset) {
  if (offset / 4 < kEndpoints) return endpoints_[offset / 4];
  switch (offset) {
    case kControl:
      return control_;
    case kStatus:
      return status();
    case kFrame:
      // RXDP is up while the bus is idle; both lines are down in a reset.
      return frame_ | (frames_missed_ << 11) | (frames_seen_ > 1 ? 1U << 13 : 0U) |
             (isAttached() && !in_bus_reset_ ? 1U << 15 : 0U);
    case kAddress:
      return address_;
    case kTable:
      return table_;
    default:
      return 0;
  }
}

void UsbDevice::write(std::uint32_t offset, std::uint32_t value) {
  if (offset / 4 < kEndpoints) writeEndpoint(offset / 4, value & 0xFFFFU);
  switch (offset) {
    case kControl:
      writeControl(value & 0xFF1FU);
      break;
    case kStatus:
      status_ &= value | ~kFlags;
      break;
    case kAddress:
      address_ = value & 0xFFU;
      break;
    case kTable:
      table_ = value & 0xFFF8U;
      break;
    default:
      break;
  }
  if ((control_ & kForcedReset) != 0) resetProtocol();
  updateLines();
}

void UsbDevice::writeEndpoint(unsigned index, std::uint32_t value) {
  std::uint32_t& endpoint = endpoints_[index];
  endpoint = (endpoint & value & (kReceived | kSent)) | (endpoint & kSetup) |
             ((endpoint ^ value) & kToggled) | (value & kPlain);
  const std::string own = " of USB endpoint register " + std::to_string(index);
  if ((endpoint >> 9 & 3U) == 2)
    around_.present.refuse("the firmware sets the isochronous mode" + own);
  else if ((endpoint >> 8 & 7U) == 1)
    around_.present.refuse("the firmware sets the double buffer" + own);
}

void UsbDevice::writeControl(std::uint32_t value) {
  const std::uint32_t before = control_;
  control_ = value;
  const bool has_pins = (value & kPowerDown) == 0;
  around_.pins.setTaken(kDataMinus, has_pins);
  around_.pins.setTaken(kDataPlus, has_pins);
  if ((value & ~before & kForcedReset) != 0) status_ |= kBusReset;
  if ((value & kResume) != 0) around_.present.refuse("the firmware signals a resume on the USB");
  if (((value ^ before) & (kForcedReset | kPowerDown | kForcedSuspend)) != 0) restartSuspendTimer();
}

void UsbDevice::reset() {
  endpoints_.fill(0);
  status_ = frame_ = address_ = table_ = 0;
  frames_seen_ = frames_missed_ = 0;
  in_bus_reset_ = false;
  writeControl(kForcedReset | kPowerDown);
  status_ = 0;
  updateLines();
}

/// What a reset on the bus clears: all of the endpoints but what they have to tell, and the address.
void UsbDevice::resetProtocol() {
  for (std::uint32_t& endpoint : endpoints_) endpoint &= kReceived | kSent;
  address_ = 0;
}

void UsbDevice::beginBusReset() {
  if (!isAttached()) return;
  checkClock();
  wake();
  status_ |= kBusReset;
  resetProtocol();
  in_bus_reset_ = true;
  frames_seen_ = 0;
  updateLines();
}

void UsbDevice::endBusReset() {
  in_bus_reset_ = false;
  restartSuspendTimer();
}

void UsbDevice::startFrame(std::uint64_t number) {
  if (!isAttached()) return;
  checkClock();
  wake();
  restartSuspendTimer();
  frames_seen_ = std::min(frames_seen_ + 1, 2U);
  frame_ = static_cast<std::uint32_t>(number & 0x7FFU);
  status_ |= kStartOfFrame;
  updateLines();
}

/// Something happens on a bus that was suspended.
void UsbDevice::wake() {
  if ((control_ & kForcedSuspend) == 0) return;
  control_ &= ~kLowPower;
  if ((status_ & kWakeUp) == 0) around_.exti.onUsbWakeUp();
  status_ |= kWakeUp;
}

void UsbDevice::checkClock() {
  const std::uint64_t usb_hz = around_.rcc.usbHz();
  const std::uint64_t bus_hz = around_.rcc.coreHz() / around_.rcc.divider(ClockBus::kApb1);
  if (!around_.present.misheard.empty()) return;
  if (usb_hz != kUsb_hz)
    around_.present.misheard =
        "the firmware runs its USB at " + std::to_string(usb_hz) +
        " Hz from the PLL (HSE and HSI of 8000000 Hz), and a full-speed device takes " +
        std::to_string(kUsb_hz) + " Hz";
  else if (bus_hz < kLeastBus_hz)
    around_.present.misheard = "the firmware runs APB1 at " + std::to_string(bus_hz) +
                               " Hz, and its USB needs " + std::to_string(kLeastBus_hz) + " Hz or more";
}

void UsbDevice::restartSuspendTimer() {
  frames_missed_ = 0;
  quiet_since_ = around_.present.cycle;
}

Cycle UsbDevice::nextEvent() const {
  constexpr unsigned kMostMissed = 3;
  if (!isAttached() || in_bus_reset_ || (control_ & kForcedSuspend) != 0 || frames_missed_ == kMostMissed)
    return kNever;
  return quiet_since_ + around_.time.cyclesIn(kFrame_s * (frames_missed_ + 1) + kLate_s);
}

void UsbDevice::runTo(Cycle cycle) {
  if (nextEvent() > cycle) return;
  frames_seen_ = 0;
  status_ |= kMissedFrame;
  if (++frames_missed_ == 3) status_ |= kSuspend;
  updateLines();
}

void UsbDevice::updateLines() {
  around_.nvic.setLine(kLowPriorityLine, (status() & control_ & 0xFF00U) != 0);
}

}  // namespace kerfbench::cortex_m_child
