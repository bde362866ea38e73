// SPDX-License-Identifier: Apache-2.0
#include "hil/source/pin_events.h"

#include <algorithm>
#include <cstring>

namespace kerfbench::source {

unsigned PinEvents::learn(const Change& change) {
  const auto known = std::ranges::find(changes_, change);
  const auto code = static_cast<unsigned>(known - changes_.begin());
  if (code >= kFar) return kWhole;  // There are no codes left.
  if (known == changes_.end()) {
    changes_.push_back(change);
    if (change.port >= levels_.size()) levels_.resize(std::size_t{change.port} + 1);
  }
  codes_of_[slotOf(change)] = static_cast<std::uint8_t>(code);
  return code;
}

void PinEvents::pushRare(PinEvent event, Tick ticks, unsigned code) {
  if (event.port >= levels_.size()) levels_.resize(std::size_t{event.port} + 1);
  if (code < kFar && ticks <= kMostFar) {
    const std::array words{kFar << kTickBits | static_cast<std::uint32_t>(ticks >> kTickBits),
                           code << kTickBits | static_cast<std::uint32_t>(ticks & kMostNear)};
    words_.append(words);
  } else {
    std::array<std::uint32_t, 1 + kWordsOfAnEvent> words{kWhole << kTickBits};
    std::memcpy(words.data() + 1, &event, sizeof event);
    words_.append(words);
  }
  levels_[event.port] = event.level;
}

bool operator==(const PinEvents& a, const PinEvents& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}
bool operator==(const PinEvents& a, const std::vector<PinEvent>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

PinEvents::Iterator::Iterator(const PinEvents& all)
    : words_(&all.words_),
      changes_(all.changes_.data()),
      at_(all.words_.begin()),
      stride_end_(at_ + std::min(words_->size(), base::SpilledVector<std::uint32_t>::kStride)),
      left_(all.size_),
      levels_(all.levels_.size()) {
  if (left_ > 0) read();
}

void PinEvents::Iterator::readRare(std::uint32_t word) {
  if (word >> kTickBits == kFar) {
    const std::uint32_t near = *at_++;
    return turn(near >> kTickBits, (word & kMostNear) << kTickBits | (near & kMostNear));
  }
  std::memcpy(&event_, at_, sizeof event_);
  at_ += kWordsOfAnEvent;
  levels_[event_.port] = event_.level;
}

void PinEvents::Iterator::passStride() {
  constexpr std::size_t kStride = base::SpilledVector<std::uint32_t>::kStride;
  const auto to = static_cast<std::size_t>(at_ - words_->begin());
  words_->giveBack(to - std::min(to, 2 * kStride), to);
  stride_end_ = at_ + std::min(words_->size() - to, kStride);
}

}  // namespace kerfbench::source
