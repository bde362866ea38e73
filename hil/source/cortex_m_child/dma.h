// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "hil/source/cortex_m_child/bus.h"
#include "hil/source/cortex_m_child/nvic.h"

namespace kerfbench::cortex_m_child {

/// DMA1 with its seven channels (STMicroelectronics 2015 RM0008, chapter 13). A transfer that a device asks
/// for takes no time; one from memory to memory takes 5 cycles for each item. Cycles of the bus that the core
/// loses are not modelled, nor is the order among channels that are asked in the same cycle.
class Dma final : public Device {
 public:
  Dma(Present& present, Nvic& nvic, Bus& bus) : present_(present), nvic_(nvic), bus_(bus) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;

  /// A device asks for a channel by its number, 1 to 7, for one transfer. False if the channel is off.
  bool request(unsigned number);
  /// Called after a channel was switched on.
  std::function<void()> on_enabled;
  /// Called with memory that was written to.
  std::function<void(std::uint32_t address, std::uint32_t bytes)> on_write;

 private:
  static constexpr unsigned kChannels = 7;
  struct Channel {
    std::uint32_t configuration{};
    std::uint32_t count{};   ///< CNDTR
    std::uint32_t reload{};  ///< What CNDTR was when the channel was switched on.
    std::uint32_t device{};
    std::uint32_t memory{};
    std::uint32_t device_at{};
    std::uint32_t memory_at{};
    Cycle done_at{kNever};  ///< End of a transfer from memory to memory.
  };

  void writeConfiguration(unsigned index, std::uint32_t value);
  void transfer(unsigned index);
  bool move(Channel& channel);
  void raise(unsigned index, std::uint32_t flags);
  void updateLines();

  Present& present_;
  Nvic& nvic_;
  Bus& bus_;
  std::array<Channel, kChannels> channels_;
  std::uint32_t status_{};
  bool is_moving_{};
};

}  // namespace kerfbench::cortex_m_child
