// SPDX-License-Identifier: Apache-2.0
// Transactions of the USB device (STMicroelectronics 2015 RM0008, 23.4).
#include <algorithm>
#include <cstdio>

#include "hil/source/cortex_m_child/usb_device.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kReset = 1U << 10, kForcedSuspend = 1U << 3, kEnabled = 1U << 7;
constexpr std::uint32_t kReceived = 1U << 15, kReceiveToggle = 1U << 14, kSetup = 1U << 11, kKind = 1U << 8,
                        kSent = 1U << 7, kSendToggle = 1U << 6;
constexpr unsigned kReceiveState = 12, kSendState = 4;  // Lowest bits of two.
constexpr std::uint32_t kDisabled = 0, kStall = 1, kNak = 2;
// Fields of a buffer descriptor, in half-words.
constexpr unsigned kSendAddress = 0, kSendCount = 1, kReceiveAddress = 2, kReceiveCount = 3;
constexpr std::uint32_t kCount = 0x3FF;

bool isControl(std::uint32_t endpoint) { return (endpoint >> 9 & 3U) == 1; }

std::uint32_t stateOf(std::uint32_t endpoint, UsbToken token) {
  return endpoint >> (token == UsbToken::kIn ? kSendState : kReceiveState) & 3U;
}

void setState(std::uint32_t& endpoint, unsigned lowest_bit, std::uint32_t state) {
  endpoint = (endpoint & ~(3U << lowest_bit)) | state << lowest_bit;
}

/// Bytes of a receive buffer: BL_SIZE and NUM_BLOCK.
std::size_t roomOf(std::uint32_t count) {
  const std::size_t blocks = count >> 10 & 0x1FU;
  return (count >> 15 & 1U) != 0 ? (blocks + 1) * 32 : blocks * 2;
}

}  // namespace

/// The register whose endpoint is meant, or kNone where no one listens.
unsigned UsbDevice::find(const UsbTarget& target) const {
  const bool is_deaf = !isAttached() || in_bus_reset_ || (control_ & kForcedSuspend) != 0 ||
                       (status_ & kReset) != 0 || address_ != (kEnabled | target.address);
  if (is_deaf) return kNone;
  for (unsigned i = 0; i < kEndpoints; ++i) {
    if ((endpoints_[i] & 0xFU) != target.endpoint || stateOf(endpoints_[i], target.token) == kDisabled)
      continue;
    if (target.token != UsbToken::kSetup || isControl(endpoints_[i])) return i;
  }
  return kNone;
}

UsbAnswer UsbDevice::poll(const UsbTarget& target) const {
  const unsigned index = find(target);
  if (index == kNone) return UsbAnswer::kNone;
  // A SETUP is taken in any state, and dropped while the last packet has not been looked at.
  if (target.token == UsbToken::kSetup)
    return (endpoints_[index] & kReceived) != 0 ? UsbAnswer::kNone : UsbAnswer::kReady;
  switch (stateOf(endpoints_[index], target.token)) {
    case kStall:
      return UsbAnswer::kStall;
    case kNak:
      return UsbAnswer::kNak;
    default:
      return UsbAnswer::kReady;
  }
}

/// Ends the run where a packet would not lie in the packet memory.
bool UsbDevice::holds(unsigned index, std::uint32_t address, std::size_t bytes) {
  if (address + bytes <= UsbPacketMemory::kBytes) return true;
  char text[160] = "";
  std::snprintf(text, sizeof text,
                "a USB buffer of endpoint register %u has %zu bytes from 0x%x on, and the packet memory ends "
                "at 0x%x",
                index, bytes, address, UsbPacketMemory::kBytes);
  if (around_.present.failure.empty()) around_.present.failure = text;
  return false;
}

/// A half-word of an endpoint's buffer descriptor.
std::uint32_t UsbDevice::descriptor(unsigned index, unsigned field) {
  const std::uint32_t address = table_ + 8 * index + 2 * field;
  return holds(index, address, 2) ? memory_.half(address) : 0;
}

UsbPacket UsbDevice::fetch(const UsbTarget& target) {
  UsbPacket packet;
  const unsigned index = find(target);
  if (index == kNone) return packet;
  packet.is_data1 = (endpoints_[index] & kSendToggle) != 0;
  const std::uint32_t address = descriptor(index, kSendAddress) & ~1U;
  const std::uint32_t count = descriptor(index, kSendCount) & kCount;
  if (!holds(index, address, count)) return packet;
  for (std::uint32_t i = 0; i < count; ++i) packet.bytes.push_back(memory_.byte(address + i));
  return packet;
}

UsbAnswer UsbDevice::receive(const UsbTarget& target, const UsbPacket& packet) {
  const unsigned index = find(target);
  if (index == kNone) return UsbAnswer::kNone;
  const std::uint32_t endpoint = endpoints_[index];
  if (target.token == UsbToken::kOut) {
    if (isControl(endpoint) && (endpoint & kKind) != 0 && !packet.bytes.empty()) return UsbAnswer::kStall;
    // A packet that was there before is acknowledged, and no more.
    if (packet.is_data1 != ((endpoint & kReceiveToggle) != 0)) return UsbAnswer::kReady;
  }
  const std::uint32_t count = descriptor(index, kReceiveCount);
  const std::uint32_t address = descriptor(index, kReceiveAddress) & ~1U;
  if (packet.bytes.size() > roomOf(count)) return UsbAnswer::kStall;
  if (!holds(index, address, packet.bytes.size())) return UsbAnswer::kNone;
  for (std::uint32_t i = 0; i < packet.bytes.size(); ++i) memory_.setByte(address + i, packet.bytes[i]);
  // A buffer over its own descriptor is written first, as on silicon.
  const std::uint32_t place = table_ + 8 * index + 2 * kReceiveCount;
  memory_.setHalf(place, static_cast<std::uint16_t>((count & ~kCount) | packet.bytes.size()));
  note(index, target);
  return UsbAnswer::kReady;
}

/// A packet has been received: what its register tells of it.
void UsbDevice::note(unsigned index, const UsbTarget& target) {
  std::uint32_t& endpoint = endpoints_[index];
  const bool is_setup = target.token == UsbToken::kSetup;
  // The kind of the last packet stays until the firmware has looked at it.
  if ((endpoint & kReceived) == 0) endpoint = is_setup ? endpoint | kSetup : endpoint & ~kSetup;
  endpoint |= kReceived;
  setState(endpoint, kReceiveState, kNak);
  if (is_setup) {
    setState(endpoint, kSendState, kNak);
    endpoint |= kReceiveToggle | kSendToggle;
  } else {
    endpoint ^= kReceiveToggle;
  }
  updateLines();
}

void UsbDevice::acknowledge(const UsbTarget& target) {
  const unsigned index = find(target);
  if (index == kNone) return;
  std::uint32_t& endpoint = endpoints_[index];
  endpoint = (endpoint ^ kSendToggle) | kSent;
  setState(endpoint, kSendState, kNak);
  updateLines();
}

}  // namespace kerfbench::cortex_m_child
