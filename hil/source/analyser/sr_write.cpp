// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "hil/source/analyser/sr_file.h"
#include "hil/source/analyser/sr_metadata.h"
#include "hil/source/analyser/sr_parts.h"
#include "hil/source/analyser/zip_archive.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

constexpr std::uint64_t kPartSamples = std::uint64_t{1} << 21U;  // Some megabytes, as sigrok has them.

/// Levels tick by tick, as bytes of samples. A copy goes on from where its original is.
class SampleCursor {
 public:
  SampleCursor(const PinRecording& recording, const SignalMap& map, std::size_t sample_bytes)
      : recording_(&recording), sample_bytes_(sample_bytes), output_(recording.outputs.begin()) {
    unsigned bit = 0;
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      wired_.at(i) = map.hasOwnWire(signal);
      sensor_bits_.at(i) = bit;
      if (!wired_.at(i)) continue;
      if (!isSensor(signal)) outputs_.push_back({*map.pin(signal), bit});
      ++bit;
    }
  }

  void fill(std::span<std::uint8_t> bytes) {
    for (std::uint8_t& byte : bytes) {
      if (byte_ == 0) takeEvents();
      byte = static_cast<std::uint8_t>(levels_ >> (8 * byte_));
      if (++byte_ < sample_bytes_) continue;
      byte_ = 0;
      ++tick_;
    }
  }
  void skip(std::uint64_t samples) {
    tick_ += samples - 1;
    takeEvents();
    ++tick_;
  }

 private:
  struct Output {
    PinId pin;
    unsigned bit{};
  };

  void takeEvents() {
    for (; output_ != recording_->outputs.end() && output_->tick <= tick_; ++output_) {
      const PinEvent event = *output_;
      for (const auto& [pin, bit] : outputs_) {
        if (pin.port == event.port && (event.changed >> pin.bit & 1U) != 0)
          put(bit, (event.level >> pin.bit & 1U) != 0);
      }
    }
    const auto& sensors = recording_->sensors;
    for (; sensor_ < sensors.size() && sensors[sensor_].tick <= tick_; ++sensor_) {
      const auto index = static_cast<std::size_t>(sensors[sensor_].signal);
      if (wired_.at(index)) put(sensor_bits_.at(index), sensors[sensor_].level);
    }
  }
  void put(unsigned bit, bool high) {
    const std::uint64_t mask = std::uint64_t{1} << bit;
    levels_ = high ? levels_ | mask : levels_ & ~mask;
  }

  const PinRecording* recording_;
  std::size_t sample_bytes_;
  std::vector<Output> outputs_;
  std::array<unsigned, kSignalCount> sensor_bits_{};
  std::array<bool, kSignalCount> wired_{};
  Tick tick_{};
  std::size_t byte_{};
  std::uint64_t levels_{};
  PinEvents::Iterator output_;
  std::size_t sensor_{};
};

SrMetadata metadataOf(const PinRecording& recording, const SignalMap& map) {
  if (recording.rate.num != 1 || recording.end >= kMostSrSamples)
    throw std::invalid_argument(
        "a session file needs a whole number of samples a second, and less than 2^36");
  SrMetadata metadata;
  metadata.samplerate_hz = recording.rate.den;
  metadata.samples_name = "logic-1";
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    if (map.hasOwnWire(signal))
      metadata.channels.emplace_back(static_cast<unsigned>(metadata.channels.size()), signalName(signal));
  }
  metadata.sample_bytes = std::max<std::size_t>(1, (metadata.channels.size() + 7) / 8);
  return metadata;
}

std::string problemsOf(const PinRecording& recording) {
  std::string text;
  for (const std::string& problem : recording.problems) text += vcdWords(problem) + "\n";
  const auto gap = std::ranges::find_if(
      recording.outputs, [](const PinEvent& event) { return (event.flags & PinEvent::kGap) != 0; });
  if (gap != recording.outputs.end())
    text += fmt::format("pin events were lost before {:.6f} s\n", recording.rate.seconds(gap->tick));
  return text;
}

}  // namespace

void writeSr(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map) {
  const SrMetadata metadata = metadataOf(recording, map);
  ZipWriter zip(path);
  zip.add(sr_parts::kVersion, "2");
  zip.add(sr_parts::kMetadata, srMetadataText(metadata));
  if (const std::string problems = problemsOf(recording); !problems.empty())
    zip.add(sr_parts::kProblems, problems);
  SampleCursor cursor(recording, map, metadata.sample_bytes);
  std::uint64_t left = recording.end + 1;
  for (unsigned part = 1; left > 0; ++part) {
    const std::uint64_t samples = std::min(left, kPartSamples);
    zip.add(fmt::format("{}-{}", metadata.samples_name, part), samples * metadata.sample_bytes,
            [own = cursor](std::span<std::uint8_t> block) mutable { own.fill(block); });
    cursor.skip(samples);
    left -= samples;
  }
  zip.commit();
}

}  // namespace kerfbench::source
