// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/level_runs.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace kerfbench::source {

SamplePacker::SamplePacker(std::vector<unsigned> bits) : bits_(std::move(bits)) {
  if (bits_.size() > kMostChannels) throw std::invalid_argument("too many channels");
  levels_of_byte_.resize(8);
  for (std::size_t i = 0; i < bits_.size(); ++i) {
    if (bits_[i] >= 64) throw std::invalid_argument("a channel beyond 64 bits");
    for (unsigned value = 0; value < 256; ++value) {
      if ((value >> bits_[i] % 8 & 1U) != 0) levels_of_byte_[bits_[i] / 8][value] |= std::uint32_t{1} << i;
    }
  }
}

std::uint32_t SamplePacker::levelsOf(std::uint64_t sample) const {
  std::uint32_t levels = 0;
  for (std::size_t byte = 0; sample != 0; ++byte, sample >>= 8U)
    levels |= levels_of_byte_[byte][sample & 255U];
  return levels;
}

void SamplePacker::change(std::uint64_t sample, std::uint64_t& count, std::vector<LevelRun>& runs) {
  last_ = sample;
  const std::uint32_t levels = levelsOf(sample);
  if (levels == levels_) return;
  if (count > 0) runs.push_back({count, levels_});
  count = 0;
  levels_ = levels;
}

/// Samples of one or two bytes, eight bytes at a time: each with the one before it.
template <class Sample>
void SamplePacker::addWords(std::span<const std::uint8_t> samples, std::vector<LevelRun>& runs) {
  constexpr std::size_t kBytes = sizeof(Sample);
  constexpr std::size_t kLanes = sizeof(std::uint64_t) / kBytes;
  constexpr std::uint64_t kLow = ~std::uint64_t{0} / std::numeric_limits<Sample>::max();  // 1 in each lane.
  constexpr std::uint64_t kHigh = kLow << (8 * kBytes - 1);
  const std::uint8_t* const bytes = samples.data();
  const std::size_t all = samples.size() / kBytes;
  std::uint64_t count = 0;
  std::size_t counted = 0;  // Samples that runs and count have.
  const auto look = [&](std::size_t index) {
    Sample sample = 0;
    std::memcpy(&sample, bytes + index * kBytes, kBytes);
    if (last_ == sample) return;
    count += index - counted;
    counted = index;
    change(sample, count, runs);
  };
  std::size_t at = 0;
  if (all > 0) look(at++);
  for (; at + kLanes <= all; at += kLanes) {
    std::uint64_t here = 0;
    std::uint64_t before = 0;
    std::memcpy(&here, bytes + at * kBytes, sizeof here);
    std::memcpy(&before, bytes + (at - 1) * kBytes, sizeof before);
    const std::uint64_t differs = here ^ before;
    // The highest bit of each lane that is not zero.
    std::uint64_t lanes = (((differs & ~kHigh) + ~kHigh) | differs) & kHigh;
    for (; lanes != 0; lanes &= lanes - 1)
      look(at + static_cast<std::size_t>(std::countr_zero(lanes)) / (8 * kBytes));
  }
  for (; at < all; ++at) look(at);
  count += all - counted;
  if (count > 0) runs.push_back({count, levels_});
}

void SamplePacker::add(std::span<const std::uint8_t> samples, std::size_t sample_bytes,
                       std::vector<LevelRun>& runs) {
  if (sample_bytes < 1 || sample_bytes > 8) throw std::invalid_argument("samples of other than 1 to 8 bytes");
  if (!bits_.empty() && *std::ranges::max_element(bits_) >= 8 * sample_bytes)
    throw std::invalid_argument("samples too short for a channel");
  if (samples.size() % sample_bytes != 0) throw std::invalid_argument("half a sample");
  if constexpr (std::endian::native == std::endian::little) {
    if (sample_bytes == 1) return addWords<std::uint8_t>(samples, runs);
    if (sample_bytes == 2) return addWords<std::uint16_t>(samples, runs);
  }
  std::uint64_t count = 0;
  for (std::size_t at = 0; at < samples.size(); at += sample_bytes) {
    std::uint64_t sample = 0;
    for (std::size_t i = 0; i < sample_bytes; ++i) sample |= std::uint64_t{samples[at + i]} << (8 * i);
    if (sample != last_) change(sample, count, runs);
    ++count;
  }
  if (count > 0) runs.push_back({count, levels_});
}

Listener::State Listener::add(std::vector<LevelRun>& runs) {
  std::size_t kept = 0;
  for (LevelRun run : runs) {
    if (state_ != State::kListening) break;
    if (levels_ && run.levels != *levels_) {
      any_edge_ = true;
      since_edge_ = 0;
    }
    levels_ = run.levels;
    const std::uint64_t to_limit = listen_.limit_samples - samples_;
    const std::uint64_t to_quiet = any_edge_ ? listen_.quiet_samples - since_edge_ : ~std::uint64_t{0};
    if (run.samples >= std::min(to_limit, to_quiet)) {
      state_ = to_quiet <= to_limit ? State::kQuiet : State::kLimit;
      run.samples = std::min(to_limit, to_quiet);
    }
    samples_ += run.samples;
    since_edge_ += run.samples;
    if (run.samples > 0) runs[kept++] = run;
  }
  runs.resize(kept);
  return state_;
}

}  // namespace kerfbench::source
