// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/dma.h"

#include <algorithm>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kStatus = 0x00, kClear = 0x04, kFirstChannel = 0x08, kChannelBytes = 0x14;
constexpr std::uint32_t kEnable = 1, kToDevice = 1U << 4, kCircular = 1U << 5, kDeviceMoves = 1U << 6,
                        kMemoryMoves = 1U << 7, kMemoryToMemory = 1U << 14;
constexpr std::uint32_t kAny = 1, kDone = 2, kHalf = 4, kError = 8;
constexpr unsigned kFirstInterruptLine = 11;
constexpr Cycle kItemCycles = 5;

/// Bytes of an item, from the two bits of PSIZE or MSIZE.
unsigned itemBytes(std::uint32_t code) { return 1U << std::min(code & 3U, 2U); }

}  // namespace

void Dma::reset() {
  channels_.fill({});
  status_ = 0;
  updateLines();
}

std::uint32_t Dma::read(std::uint32_t offset) {
  if (offset == kStatus) return status_;
  if (offset < kFirstChannel || (offset - kFirstChannel) / kChannelBytes >= kChannels) return 0;
  const Channel& channel = channels_[(offset - kFirstChannel) / kChannelBytes];
  switch ((offset - kFirstChannel) % kChannelBytes) {
    case 0x0:
      return channel.configuration;
    case 0x4:
      return channel.count;
    case 0x8:
      return channel.device;
    case 0xC:
      return channel.memory;
    default:
      return 0;
  }
}

void Dma::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kClear) {
    for (unsigned i = 0; i < kChannels; ++i) {
      const std::uint32_t flags = value >> (4 * i) & 0xFU;
      status_ &= ~(((flags & kAny) != 0 ? 0xFU : flags) << (4 * i));
      if ((status_ >> (4 * i) & 0xEU) == 0) status_ &= ~(kAny << (4 * i));
    }
    return updateLines();
  }
  if (offset < kFirstChannel || (offset - kFirstChannel) / kChannelBytes >= kChannels) return;
  const unsigned index = (offset - kFirstChannel) / kChannelBytes;
  Channel& channel = channels_[index];
  const bool is_on = (channel.configuration & kEnable) != 0;
  switch ((offset - kFirstChannel) % kChannelBytes) {
    case 0x0:
      return writeConfiguration(index, value & 0x7FFFU);
    case 0x4:
      if (!is_on) channel.count = value & 0xFFFFU;
      return;
    case 0x8:
      if (!is_on) channel.device = value;
      return;
    case 0xC:
      if (!is_on) channel.memory = value;
      return;
    default:
      return;
  }
}

void Dma::writeConfiguration(unsigned index, std::uint32_t value) {
  Channel& channel = channels_[index];
  const bool was_on = (channel.configuration & kEnable) != 0;
  channel.configuration = value;
  if ((value & kEnable) == 0) channel.done_at = kNever;
  if ((value & kEnable) != 0 && !was_on) {
    channel.reload = channel.count;
    channel.device_at = channel.device;
    channel.memory_at = channel.memory;
    if ((value & kMemoryToMemory) != 0 && channel.count != 0)
      channel.done_at = present_.cycle + kItemCycles * channel.count;
  }
  updateLines();
  if ((value & kEnable) != 0 && !was_on && on_enabled) on_enabled();
}

Cycle Dma::nextEvent() const {
  Cycle next = kNever;
  for (const Channel& channel : channels_) next = std::min(next, channel.done_at);
  return next;
}

void Dma::runTo(Cycle cycle) {
  for (unsigned i = 0; i < kChannels; ++i) {
    if (channels_[i].done_at > cycle) continue;
    channels_[i].done_at = kNever;
    while (channels_[i].count != 0 && (channels_[i].configuration & kEnable) != 0) transfer(i);
  }
}

bool Dma::request(unsigned number) {
  const Channel& channel = channels_[number - 1];
  // What a transfer does to a device can make the device ask again; its turn comes after this one.
  if ((channel.configuration & kEnable) == 0 || (channel.configuration & kMemoryToMemory) != 0 ||
      channel.count == 0 || is_moving_)
    return false;
  transfer(number - 1);
  return true;
}

void Dma::transfer(unsigned index) {
  Channel& channel = channels_[index];
  is_moving_ = true;
  const bool is_moved = move(channel);
  is_moving_ = false;
  if (!is_moved) {
    channel.configuration &= ~kEnable;
    return raise(index, kError);
  }
  if (--channel.count == channel.reload / 2) raise(index, kHalf);
  if (channel.count != 0) return;
  if ((channel.configuration & kCircular) != 0 && (channel.configuration & kMemoryToMemory) == 0) {
    channel.count = channel.reload;
    channel.device_at = channel.device;
    channel.memory_at = channel.memory;
  }
  raise(index, kDone);
}

bool Dma::move(Channel& channel) {
  const unsigned device_bytes = itemBytes(channel.configuration >> 8);
  const unsigned memory_bytes = itemBytes(channel.configuration >> 10);
  const bool to_device = (channel.configuration & kToDevice) != 0;
  const std::uint32_t from = to_device ? channel.memory_at : channel.device_at;
  const std::uint32_t to = to_device ? channel.device_at : channel.memory_at;
  const unsigned bytes = to_device ? device_bytes : memory_bytes;
  const auto value = bus_.readAny(from, to_device ? memory_bytes : device_bytes);
  if (!value || !bus_.writeAny(to, bytes, *value)) return false;
  if (on_write) on_write(to, bytes);
  if ((channel.configuration & kDeviceMoves) != 0) channel.device_at += device_bytes;
  if ((channel.configuration & kMemoryMoves) != 0) channel.memory_at += memory_bytes;
  return true;
}

void Dma::raise(unsigned index, std::uint32_t flags) {
  status_ |= (flags | kAny) << (4 * index);
  updateLines();
}

void Dma::updateLines() {
  for (unsigned i = 0; i < kChannels; ++i) {
    // TCIE, HTIE and TEIE are at the places of their flags.
    const std::uint32_t up = status_ >> (4 * i) & channels_[i].configuration & (kDone | kHalf | kError);
    nvic_.setLine(kFirstInterruptLine + i, up != 0);
  }
}

}  // namespace kerfbench::cortex_m_child
