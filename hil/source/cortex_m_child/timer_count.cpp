// SPDX-License-Identifier: Apache-2.0
// How a timer counts: its clock, its turning points, its events.
#include <algorithm>

#include "hil/source/cortex_m_child/timer.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kOnePulse = 1U << 3, kNoUpdate = 1U << 1, kOnlyOverflow = 1U << 2;
constexpr std::uint32_t kUpdateFlag = 1, kUpdateDma = 1U << 8;
constexpr std::uint32_t kCounterEnd = 0x10000;
constexpr std::uint32_t kFar = 0xFFFFFFFF;

}  // namespace

Timer::Source Timer::source() const {
  const std::uint32_t slave_mode = slave_ & 7U;
  if (slave_mode >= 1 && slave_mode <= 3) return Source::kEncoder;
  const bool has_external_clock = slave_mode == 7 || (slave_ >> 14 & 1U) != 0;
  return has_external_clock ? Source::kExternal : Source::kInternal;
}

Cycle Timer::cyclesPerCount() const {
  const ClockBus bus = number_ == 1 ? ClockBus::kApb2 : ClockBus::kApb1;
  return Cycle{rcc_.timerDivider(bus)} * (active_prescaler_ + 1U);
}

/// Counts until the counter turns: to 0 counting up, to ARR counting down, or its direction if centred.
std::uint32_t Timer::stepsToTurn() const {
  if (isCentred())
    return down_ ? std::max(count_, 1U) : std::max(active_top_ - std::min(count_, active_top_), 1U);
  if (down_) return count_ + 1;
  return count_ <= active_top_ ? active_top_ - count_ + 1 : kCounterEnd - count_;
}

/// Counts until the counter has a value, if it comes to it before it turns, or by that.
std::uint32_t Timer::stepsTo(std::uint32_t value) const {
  if (!down_ && value > count_ && (value <= active_top_ || count_ > active_top_)) return value - count_;
  if (down_ && value < count_) return count_ - value;
  return kFar;
}

bool Timer::isWatched(unsigned channel) const {
  const std::uint32_t bit = 2U << channel;
  const bool has_output = !isInput(channel) && mode(channel) != 0 && (enable_ >> (4 * channel) & 5U) != 0;
  return has_output || (interrupts_ & (bit | bit << 8)) != 0;
}

bool Timer::watchesUpdate() const {
  if ((interrupts_ & (kUpdateFlag | kUpdateDma)) != 0 || (control1_ & kOnePulse) != 0) return true;
  for (unsigned i = 0; i < kChannels; ++i) {
    if (isWatched(i)) return true;
  }
  return false;
}

std::uint32_t Timer::stepsToNext(bool only_watched) const {
  std::uint32_t steps = kFar;
  bool is_watched = (interrupts_ & (kUpdateFlag | kUpdateDma)) != 0 || (control1_ & kOnePulse) != 0;
  for (unsigned i = 0; i < kChannels; ++i) {
    const bool is_own_watched = isWatched(i);
    is_watched = is_watched || is_own_watched;
    if (isInput(i) || (only_watched && !is_own_watched)) continue;
    steps = std::min(steps, stepsTo(channels_[i].active_compare));
  }
  return is_watched || !only_watched ? std::min(steps, stepsToTurn()) : steps;
}

Cycle Timer::nextEvent() const {
  if (!counts() || source() != Source::kInternal || active_top_ == 0) return kNever;
  const std::uint32_t steps = stepsToNext(true);
  return steps == kFar ? kNever : base_ + Cycle{steps} * cyclesPerCount();
}

void Timer::runTo(Cycle cycle) {
  if (!counts() || source() != Source::kInternal || active_top_ == 0) {
    base_ = cycle;
    return;
  }
  while (counts()) {
    const Cycle period = cyclesPerCount();
    Cycle steps = cycle > base_ ? (cycle - base_) / period : 0;
    if (steps == 0) return;
    skipWholePeriods(steps);
    const Cycle next = std::min<Cycle>(steps, stepsToNext(false));
    base_ += next * period;
    count(next);
  }
}

/// Periods that nobody watches leave nothing but flags.
void Timer::skipWholePeriods(Cycle& steps) {
  if (watchesUpdate() || isCentred() || down_ || count_ > active_top_ || repetitions_ != 0) return;
  const Cycle turn_steps = Cycle{active_top_} + 1;
  if (steps < 3 * turn_steps) return;
  const Cycle skipped = (steps / turn_steps - 2) * turn_steps;
  base_ += skipped * cyclesPerCount();
  steps -= skipped;
}

/// Makes a number of counts of which only the last may come to a turn or a compare value.
void Timer::count(Cycle steps) {
  if (steps == 0) return;
  const bool is_event = steps >= stepsToNext(false);
  if (steps >= stepsToTurn()) {
    turn();
  } else {
    count_ = down_ ? count_ - static_cast<std::uint32_t>(steps) : count_ + static_cast<std::uint32_t>(steps);
  }
  if (!is_event) return;
  compareAll();
  showOutputs();
}

void Timer::turn() {
  if (isCentred()) {
    count_ = down_ ? 0 : active_top_;
    down_ = !down_;
    onUpdate(false);
  } else if (down_) {
    count_ = active_top_;
    onUpdate(false);
    count_ = active_top_;
  } else {
    const bool is_overflow = count_ <= active_top_;
    count_ = 0;
    if (is_overflow) onUpdate(false);
  }
}

void Timer::compareAll() {
  for (unsigned i = 0; i < kChannels; ++i) {
    if (isInput(i)) continue;
    const bool is_match = channels_[i].active_compare == count_;
    updateReference(i, is_match);
    // Centred, the flag is set counting down, up, or both: CMS 1, 2, 3. At the top, down_ is true already.
    const std::uint32_t alignment = control1_ >> 5 & 3U;
    const bool is_flagged = alignment == 0 || alignment == 3 || (alignment == 1) == down_;
    if (is_match && is_flagged) {
      raise(2U << i);
      if ((interrupts_ >> (9 + i) & 1U) != 0) {
        static constexpr unsigned kDma[4][4] = {{2, 3, 6, 4}, {5, 7, 1, 7}, {6, 0, 2, 3}, {1, 4, 5, 0}};
        if (const unsigned channel = kDma[number_ - 1][i]; channel != 0) (void)dma_.request(channel);
      }
    }
  }
}

void Timer::loadShadows() {
  active_prescaler_ = prescaler_;
  active_top_ = top_;
  repetitions_left_ = repetitions_;
  for (Channel& channel : channels_) channel.active_compare = channel.compare;
}

void Timer::onUpdate(bool by_software) {
  if (!by_software && repetitions_left_ > 0) {
    --repetitions_left_;
    return;
  }
  const bool stops = (control1_ & kOnePulse) != 0 && !by_software;
  if (stops) control1_ &= ~1U;
  if ((control1_ & kNoUpdate) != 0) return;
  loadShadows();
  if (by_software && (control1_ & kOnlyOverflow) != 0) return;
  raise(kUpdateFlag);
  static constexpr unsigned kDma[] = {5, 2, 3, 7};
  if ((interrupts_ & kUpdateDma) != 0) (void)dma_.request(kDma[number_ - 1]);
}

/// One count by an edge of an encoder or an external clock.
void Timer::prescale(bool up) {
  if (!counts() || (source() == Source::kExternal && active_top_ == 0)) return;
  if (++prescaled_ <= active_prescaler_) return;
  prescaled_ = 0;
  if (source() == Source::kEncoder) down_ = !up;
  count(1);
}

void Timer::capture(unsigned channel) {
  Channel& own = channels_[channel];
  const unsigned every = 1U << (modes_[channel / 2] >> (8 * (channel % 2) + 2) & 3U);
  if (++own.captures < every) return;
  own.captures = 0;
  const std::uint32_t flag = 2U << channel;
  if ((status_ & flag) != 0) raise(flag << 8);
  own.compare = own.active_compare = count_;
  raise(flag);
  if ((interrupts_ >> (9 + channel) & 1U) != 0) {
    static constexpr unsigned kDma[4][4] = {{2, 3, 6, 4}, {5, 7, 1, 7}, {6, 0, 2, 3}, {1, 4, 5, 0}};
    if (const unsigned dma = kDma[number_ - 1][channel]; dma != 0) (void)dma_.request(dma);
  }
}

/// An edge of an encoder's line (RM0008, table "Counting direction versus encoder signals").
void Timer::encode(unsigned channel, bool level) {
  const std::uint32_t slave_mode = slave_ & 7U;
  const bool counts_it = channel == 0 ? slave_mode != 1 : slave_mode != 2;
  if (!counts_it) return;
  const bool rises = level != isInverted(channel);
  const unsigned other = 1U - channel;
  const bool other_is_high = channels_[other].input != isInverted(other);
  const bool up = channel == 0 ? rises != other_is_high : rises == other_is_high;
  prescale(up);
}

void Timer::onInput(unsigned channel, bool level) {
  channels_[channel].input = level;
  const bool is_active_edge = level != isInverted(channel);
  const std::uint32_t selection = slave_ >> 4 & 7U;
  if (source() == Source::kEncoder && channel < 2) encode(channel, level);
  if ((slave_ & 7U) == 7 && channel < 2) {
    const bool is_clock = selection == 4 ? channel == 0 : selection == 5 + channel && is_active_edge;
    if (is_clock) prescale(true);
  }
  for (const unsigned own : {channel, channel ^ 1U}) {
    const std::uint32_t select = modes_[own / 2] >> (8 * (own % 2)) & 3U;
    const bool is_its_input = select == (own == channel ? 1U : 2U);
    if (!is_its_input || (enable_ >> (4 * own) & 1U) == 0) continue;
    if ((level != isInverted(own))) capture(own);
  }
}

void Timer::onTrigger(bool level) {
  const bool is_inverted = (slave_ >> 15 & 1U) != 0;
  const bool is_clock = (slave_ >> 14 & 1U) != 0 || ((slave_ & 7U) == 7 && (slave_ >> 4 & 7U) == 7);
  if (!is_clock || level == is_inverted) return;
  const std::uint32_t every = 1U << (slave_ >> 12 & 3U);
  if (++trigger_skipped_ < every) return;
  trigger_skipped_ = 0;
  prescale(true);
}

void Timer::onPins(unsigned port, std::uint32_t changed) {
  if (!listens_) return;
  const auto has_changed = [&](Pin pin) { return pin.port == port && (changed >> pin.bit & 1U) != 0; };
  for (unsigned i = 0; i < kChannels; ++i) {
    const auto& pin = channels_[i].pin;
    if (!pin || !has_changed(*pin)) continue;
    runTo(present_.cycle);
    if (const bool level = pins_.level(*pin); level != channels_[i].input) onInput(i, level);
  }
  if (const Pin pin = triggerPin(); has_changed(pin)) {
    runTo(present_.cycle);
    onTrigger(pins_.level(pin));
  }
}

}  // namespace kerfbench::cortex_m_child
