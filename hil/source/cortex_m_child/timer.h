// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/dma.h"
#include "hil/source/cortex_m_child/exti.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/pins.h"
#include "hil/source/cortex_m_child/rcc.h"

namespace kerfbench::cortex_m_child {

/// TIM1 to TIM4 (STMicroelectronics 2015 RM0008, chapters 14 and 15): counting up, down and centre-aligned,
/// prescaler and preloads, update and compare events with interrupts and DMA, compare outputs with polarity,
/// one pulse, repetitions and main output of TIM1, encoder, external clocks from pins, input capture.
///
/// Counts are worked out when something depends on them: an enabled event, or the firmware's access. What is
/// not modelled ends the run in words: synchronization of timers with each other, DMA bursts, dead time.
/// Filters of inputs do not delay.
class Timer final : public Device {
 public:
  static constexpr unsigned kChannels = 4;
  struct Surroundings {
    Present& present;
    Nvic& nvic;
    Dma& dma;
    Pins& pins;
    const Afio& afio;
    const Rcc& rcc;
  };

  /// @param number 1 to 4.
  Timer(const Surroundings& around, unsigned number);

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;

  /// Levels of pins have changed.
  void onPins(unsigned port, std::uint32_t changed);
  /// AFIO has moved the pins.
  void onRemap();

 private:
  enum class Source { kInternal, kEncoder, kExternal };
  /// What the pins were told last.
  struct Output {
    bool is_taken{};
    bool level{};
    bool operator==(const Output&) const = default;
  };
  struct Channel {
    std::uint32_t compare{};  ///< CCR as it was written, and as it takes part in comparisons.
    std::uint32_t active_compare{};
    bool reference{};  ///< OCxREF
    std::optional<Pin> pin;
    std::optional<Pin> complement;
    Output shown, complement_shown;
    unsigned captures{};  ///< Edges that the input's prescaler has passed over.
    bool input{};         ///< Level of the input, as its pin last had it.
  };

  // timer_count.cpp
  [[nodiscard]] Source source() const;
  [[nodiscard]] bool counts() const { return (control1_ & 1U) != 0; }
  [[nodiscard]] bool isCentred() const { return (control1_ >> 5 & 3U) != 0; }
  [[nodiscard]] Cycle cyclesPerCount() const;
  [[nodiscard]] std::uint32_t stepsTo(std::uint32_t value) const;
  [[nodiscard]] std::uint32_t stepsToTurn() const;
  [[nodiscard]] std::uint32_t stepsToNext(bool only_watched) const;
  [[nodiscard]] bool isWatched(unsigned channel) const;
  [[nodiscard]] bool watchesUpdate() const;
  void count(Cycle steps);
  void skipWholePeriods(Cycle& steps);
  void turn();
  void compareAll();
  void onUpdate(bool by_software);
  void loadShadows();
  void onExternalEdge(bool up);
  void prescale(bool up);
  void capture(unsigned channel);
  void onInput(unsigned channel, bool level);
  void onTrigger(bool level);
  void encode(unsigned channel, bool level);

  // timer_outputs.cpp
  [[nodiscard]] std::uint32_t mode(unsigned channel) const {
    return modes_[channel / 2] >> (8 * (channel % 2) + 4) & 7U;
  }
  [[nodiscard]] bool isInput(unsigned channel) const {
    return (modes_[channel / 2] >> (8 * (channel % 2)) & 3U) != 0;
  }
  [[nodiscard]] bool isPreloaded(unsigned channel) const;
  [[nodiscard]] bool isInverted(unsigned channel) const { return (enable_ >> (4 * channel + 1) & 1U) != 0; }
  void updateReference(unsigned channel, bool is_match);
  void showOutputs();
  void show(unsigned channel);
  void put(const std::optional<Pin>& pin, Output& shown, Output wanted);
  void findPins();
  [[nodiscard]] std::optional<Pin> pinOf(unsigned channel) const;
  [[nodiscard]] std::optional<Pin> complementOf(unsigned channel) const;
  [[nodiscard]] Pin triggerPin() const;

  // timer.cpp
  void writeControl(std::uint32_t offset, std::uint32_t value);
  void writeCount(std::uint32_t offset, std::uint32_t value);
  void generate(std::uint32_t events);
  void raise(std::uint32_t flags);
  void updateLines();
  void refuseUnmodelled();
  void listen();

  Present& present_;
  Nvic& nvic_;
  Dma& dma_;
  Pins& pins_;
  const Afio& afio_;
  const Rcc& rcc_;
  unsigned number_;
  std::array<Channel, kChannels> channels_;
  std::uint32_t control1_{};
  std::uint32_t control2_{};
  std::uint32_t slave_{};
  std::uint32_t interrupts_{};  ///< DIER
  std::uint32_t status_{};
  std::uint32_t modes_[2]{};  ///< CCMR1 and CCMR2.
  std::uint32_t enable_{};    ///< CCER
  std::uint32_t count_{};
  std::uint32_t prescaler_{};
  std::uint32_t active_prescaler_{};
  std::uint32_t top_{0xFFFF};  ///< ARR
  std::uint32_t active_top_{0xFFFF};
  std::uint32_t repetitions_{};
  std::uint32_t repetitions_left_{};
  std::uint32_t break_{};  ///< BDTR
  bool down_{};
  Cycle base_{};               ///< Cycle at which count_ was reached.
  std::uint32_t prescaled_{};  ///< Edges of an external clock since the last count.
  std::uint32_t trigger_skipped_{};
  bool listens_{};
};

}  // namespace kerfbench::cortex_m_child
