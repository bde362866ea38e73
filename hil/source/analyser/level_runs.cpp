// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/level_runs.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace kerfbench::source {

SamplePacker::SamplePacker(std::vector<unsigned> bits) : bits_(std::move(bits)) {
  if (bits_.size() > kMostChannels) throw std::invalid_argument("too many channels");
}

std::uint32_t SamplePacker::levelsOf(std::uint64_t sample) const {
  std::uint32_t levels = 0;
  for (std::size_t i = 0; i < bits_.size(); ++i)
    levels |= static_cast<std::uint32_t>(sample >> bits_[i] & 1U) << i;
  return levels;
}

void SamplePacker::add(std::span<const std::uint8_t> samples, std::size_t sample_bytes,
                       std::vector<LevelRun>& runs) {
  if (sample_bytes < 1 || sample_bytes > 8) throw std::invalid_argument("samples of other than 1 to 8 bytes");
  if (!bits_.empty() && *std::ranges::max_element(bits_) >= 8 * sample_bytes)
    throw std::invalid_argument("samples too short for a channel");
  if (samples.size() % sample_bytes != 0) throw std::invalid_argument("half a sample");
  std::uint64_t count = 0;
  const auto flush = [&] {
    if (count > 0) runs.push_back({count, levels_});
    count = 0;
  };
  for (std::size_t at = 0; at < samples.size(); at += sample_bytes) {
    std::uint64_t sample = 0;
    for (std::size_t i = 0; i < sample_bytes; ++i) sample |= std::uint64_t{samples[at + i]} << (8 * i);
    if (sample != last_) {
      last_ = sample;
      const std::uint32_t levels = levelsOf(sample);
      if (levels != levels_) flush();
      levels_ = levels;
    }
    ++count;
  }
  flush();
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
