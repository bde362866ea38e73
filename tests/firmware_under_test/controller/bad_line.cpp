// SPDX-License-Identifier: Apache-2.0
#include "bad_line.h"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::controller_test {

std::string_view kindName(Corruption::Kind kind) {
  static constexpr std::array<std::string_view, Corruption::kKinds> kNames{
      "drop", "repeat", "flip", "overwrite", "insert", "replay", "delay", "noise"};
  return kNames.at(static_cast<std::size_t>(kind));
}

BadLine::BadLine(std::vector<Corruption> events, std::uint32_t seed)
    : events_(std::move(events)), random_(seed) {}

void BadLine::put(std::uint8_t byte, std::uint64_t tick) {
  for (; next_ < events_.size() && events_[next_].at_byte <= count_; ++next_) begin(events_[next_], tick);
  ++count_;
  history_.push_back(byte);
  unsigned value = byte;
  value ^= std::exchange(flip_, 0U);
  if (overwrite_ > 0) {
    --overwrite_;
    value = static_cast<unsigned>(random_() & 0xFFU);
  }
  if (noise_ > 0.0 && static_cast<double>(random_()) < noise_ * 4294967296.0) {
    value ^= 1U << (random_() & 7U);
  }
  if (drop_ > 0) {
    --drop_;
    return;
  }
  out(static_cast<std::uint8_t>(value), tick);
}

void BadLine::begin(const Corruption& event, std::uint64_t tick) {
  switch (event.kind) {
    case Corruption::Kind::kDrop:
      drop_ = event.length;
      break;
    case Corruption::Kind::kRepeat: {
      const std::size_t n = std::min(event.length, history_.size());
      const std::vector<std::uint8_t> last(history_.end() - static_cast<std::ptrdiff_t>(n), history_.end());
      for (const std::uint8_t byte : last) out(byte, tick);
      break;
    }
    case Corruption::Kind::kFlip:
      for (std::size_t i = 0; i < event.length; ++i) flip_ ^= 1U << (random_() & 7U);
      break;
    case Corruption::Kind::kOverwrite:
      overwrite_ = event.length;
      break;
    case Corruption::Kind::kInsert:
      for (std::size_t i = 0; i < event.length; ++i) out(static_cast<std::uint8_t>(random_() & 0xFFU), tick);
      break;
    case Corruption::Kind::kReplay:
      replay(event.length, tick);
      break;
    case Corruption::Kind::kDelay:
      not_before_ = std::max(not_before_, tick + event.delay);
      break;
    case Corruption::Kind::kNoise:
      noise_ = event.share;
      break;
  }
}

/// Repeats earlier bytes, which were once a frame, whole or not.
void BadLine::replay(std::size_t length, std::uint64_t tick) {
  if (history_.empty()) return;
  std::size_t from = random_() % history_.size();
  while (from > 0 && history_[from] != KB_SYNC) --from;
  const std::size_t end = std::min(history_.size(), from + length);
  for (std::size_t i = from; i < end; ++i) out(history_[i], tick);
}

void BadLine::out(std::uint8_t byte, std::uint64_t tick) {
  waiting_.push_back({std::max(tick, not_before_), byte});
}

std::vector<std::uint8_t> BadLine::take(std::uint64_t tick) {
  std::vector<std::uint8_t> bytes;
  while (!waiting_.empty() && waiting_.front().tick <= tick) {
    bytes.push_back(waiting_.front().byte);
    waiting_.pop_front();
  }
  return bytes;
}

}  // namespace kerfbench::controller_test
