// SPDX-License-Identifier: Apache-2.0
// Compare outputs of a timer, and the pins that AFIO gives it.
#include "hil/source/cortex_m_child/timer.h"

namespace kerfbench::cortex_m_child {
namespace {

enum Port : unsigned { kA, kB, kC, kD, kE };

constexpr unsigned kForcedLow = 4, kForcedHigh = 5, kPwm1 = 6, kPwm2 = 7;

}  // namespace

bool Timer::isPreloaded(unsigned channel) const {
  return (modes_[channel / 2] >> (8 * (channel % 2) + 3) & 1U) != 0;
}

/// OCxREF after a count or a change of its mode.
void Timer::updateReference(unsigned channel, bool is_match) {
  Channel& own = channels_[channel];
  switch (mode(channel)) {
    case 1:
    case 2:
    case 3:
      if (is_match) own.reference = mode(channel) == 3 ? !own.reference : mode(channel) == 1;
      return;
    case kForcedLow:
    case kForcedHigh:
      own.reference = mode(channel) == kForcedHigh;
      return;
    case kPwm1:
    case kPwm2: {
      const bool is_active = down_ ? count_ <= own.active_compare : count_ < own.active_compare;
      own.reference = is_active == (mode(channel) == kPwm1);
      return;
    }
    default:
      return;
  }
}

void Timer::showOutputs() {
  for (unsigned i = 0; i < kChannels; ++i) show(i);
}

void Timer::show(unsigned channel) {
  Channel& own = channels_[channel];
  if (isInput(channel)) return;
  const bool is_main_on = number_ != 1 || (break_ >> 15 & 1U) != 0;
  const std::uint32_t bits = enable_ >> (4 * channel);
  const bool is_on = (bits & 1U) != 0;
  // A complementary output that is alone is not inverted (RM0008, table of output control bits).
  const bool complement_level = (is_on ? !own.reference : own.reference) != ((bits & 8U) != 0);
  put(own.pin, own.shown, {is_on && is_main_on, own.reference != ((bits & 2U) != 0)});
  put(own.complement, own.complement_shown, {(bits & 4U) != 0 && is_main_on, complement_level});
}

void Timer::put(const std::optional<Pin>& pin, Output& shown, Output wanted) {
  if (!pin || shown == wanted) return;
  shown = wanted;
  pins_.setAlternate(*pin, wanted.is_taken, wanted.level);
}

void Timer::onRemap() {
  runTo(present_.cycle);
  for (Channel& channel : channels_) {
    put(channel.pin, channel.shown, {});
    put(channel.complement, channel.complement_shown, {});
  }
  findPins();
  showOutputs();
}

void Timer::findPins() {
  for (unsigned i = 0; i < kChannels; ++i) {
    channels_[i].pin = pinOf(i);
    channels_[i].complement = complementOf(i);
    channels_[i].input = channels_[i].pin && pins_.level(*channels_[i].pin);
  }
}

std::optional<Pin> Timer::pinOf(unsigned channel) const {
  static constexpr Pin kTim1[2][4] = {{{kA, 8}, {kA, 9}, {kA, 10}, {kA, 11}},
                                      {{kE, 9}, {kE, 11}, {kE, 13}, {kE, 14}}};
  static constexpr Pin kTim2[4][4] = {{{kA, 0}, {kA, 1}, {kA, 2}, {kA, 3}},
                                      {{kA, 15}, {kB, 3}, {kA, 2}, {kA, 3}},
                                      {{kA, 0}, {kA, 1}, {kB, 10}, {kB, 11}},
                                      {{kA, 15}, {kB, 3}, {kB, 10}, {kB, 11}}};
  static constexpr Pin kTim3[4][4] = {{{kA, 6}, {kA, 7}, {kB, 0}, {kB, 1}},
                                      {{kA, 6}, {kA, 7}, {kB, 0}, {kB, 1}},
                                      {{kB, 4}, {kB, 5}, {kB, 0}, {kB, 1}},
                                      {{kC, 6}, {kC, 7}, {kC, 8}, {kC, 9}}};
  static constexpr Pin kTim4[2][4] = {{{kB, 6}, {kB, 7}, {kB, 8}, {kB, 9}},
                                      {{kD, 12}, {kD, 13}, {kD, 14}, {kD, 15}}};
  const std::uint32_t remap = afio_.remap();
  switch (number_) {
    case 1:
      return kTim1[(remap >> 6 & 3U) == 3 ? 1 : 0][channel];
    case 2:
      return kTim2[remap >> 8 & 3U][channel];
    case 3:
      return kTim3[remap >> 10 & 3U][channel];
    default:
      return kTim4[remap >> 12 & 1U][channel];
  }
}

std::optional<Pin> Timer::complementOf(unsigned channel) const {
  static constexpr Pin kPins[3][3] = {
      {{kB, 13}, {kB, 14}, {kB, 15}}, {{kA, 7}, {kB, 0}, {kB, 1}}, {{kE, 8}, {kE, 10}, {kE, 12}}};
  if (number_ != 1 || channel == 3) return std::nullopt;
  const std::uint32_t remap = afio_.remap() >> 6 & 3U;
  return kPins[remap == 3 ? 2 : remap & 1U][channel];
}

/// The pin of ETR.
Pin Timer::triggerPin() const {
  switch (number_) {
    case 1:
      return (afio_.remap() >> 6 & 3U) == 3 ? Pin{kE, 7} : Pin{kA, 12};
    case 2:
      return (afio_.remap() >> 8 & 1U) != 0 ? Pin{kA, 15} : Pin{kA, 0};
    case 3:
      return {kD, 2};
    default:
      return {kE, 0};
  }
}

}  // namespace kerfbench::cortex_m_child
