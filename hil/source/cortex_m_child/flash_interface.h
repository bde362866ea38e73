// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/nvic.h"

namespace kerfbench::cortex_m_child {

/// Flash memory interface (STMicroelectronics 2015 RM0008, chapter 3; PM0075): wait states, unlocking,
/// programming of half-words and erasing. The core waits while the flash is busy, because it executes from
/// it: 52.5 us for a half-word and 20 ms for an erase (typical and shortest of DS5319). What is programmed
/// lasts until the end of the run; the image's file is not touched. Option bytes cannot be changed.
class FlashInterface final : public Device {
 public:
  FlashInterface(Present& present, Nvic& nvic, const CoreTime& time, std::span<std::uint8_t> flash,
                 std::uint32_t page_bytes)
      : present_(present), nvic_(nvic), time_(time), flash_(flash), page_bytes_(page_bytes) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  /// A store of the core to an offset in the flash. False where the silicon answers with a bus fault.
  bool program(std::uint32_t offset, unsigned bytes, std::uint32_t value);
  [[nodiscard]] unsigned waitStates() const { return access_ & 7U; }
  [[nodiscard]] bool prefetches() const { return (access_ & 0x10U) != 0; }
  /// Called when ACR has changed.
  std::function<void()> on_timing;
  /// Called with offset and size of what an erase has cleared.
  std::function<void(std::uint32_t offset, std::uint32_t bytes)> on_erase;

 private:
  void unlock(std::uint32_t key);
  void erase();
  void updateLines();

  Present& present_;
  Nvic& nvic_;
  const CoreTime& time_;
  std::span<std::uint8_t> flash_;
  std::uint32_t page_bytes_;
  std::uint32_t access_{0x30};
  std::uint32_t status_{};
  std::uint32_t control_{0x80};
  std::uint32_t address_{};
  unsigned keys_{};  ///< Keys that were right so far.
  bool is_barred_{};
};

}  // namespace kerfbench::cortex_m_child
