// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hil/base/progress.h"
#include "hil/source/analyser/level_runs.h"
#include "hil/source/analyser/run_recorder.h"
#include "hil/source/analyser/sr_file.h"
#include "hil/source/analyser/sr_metadata.h"
#include "hil/source/analyser/sr_parts.h"
#include "hil/source/analyser/zip_archive.h"
#include "hil/source/pin_capture.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

constexpr std::uint64_t kMostText = std::uint64_t{1} << 20U;
constexpr std::uint64_t kMostSampleBytes = std::uint64_t{64} << 30U;

class SrReader {
 public:
  SrReader(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
           const base::ProgressFn& progress)
      : path_(path.string()), map_(map), names_(names), progress_(progress), zip_(path) {}

  PinRecording read() {
    if (zip_.sizeOf(sr_parts::kVersion).value_or(0) == 0 || !zip_.sizeOf(sr_parts::kMetadata))
      faults_.emplace_back("no session of sigrok: a part 'version' and a part 'metadata' are expected");
    refuse();
    const std::string version = zip_.text(sr_parts::kVersion, kMostText);
    if (!version.starts_with('1') && !version.starts_with('2'))
      faults_.emplace_back("a session of another version than 1 or 2");
    metadata_ = readSrMetadata(zip_.text(sr_parts::kMetadata, kMostText), faults_);
    findChannels();
    findParts();
    refuse();
    return record();
  }

 private:
  void refuse() const {
    std::string text;
    for (const std::string& fault : faults_) text += (text.empty() ? "" : "\n") + path_ + ": " + fault;
    if (!text.empty()) throw std::runtime_error(text);
  }

  /// The channel of a signal; more than one is a fault.
  std::optional<unsigned> channelOf(Signal signal) {
    std::optional<unsigned> bit;
    const auto named = std::ranges::find(names_, signal, &ChannelNames::value_type::first);
    for (const auto& [place, name] : metadata_.channels) {
      if (name != signalName(signal) && (named == names_.end() || name != named->second)) continue;
      if (bit) faults_.push_back(fmt::format("more than one channel for {}", signalName(signal)));
      bit = place;
    }
    return bit;
  }

  [[nodiscard]] bool needed(Signal signal) const {
    if (isSensor(signal)) return false;
    return names_.empty() ||
           std::ranges::find(names_, signal, &ChannelNames::value_type::first) != names_.end();
  }

  void findChannels() {
    if (metadata_.channels.empty()) {
      if (faults_.empty()) faults_.emplace_back("no channels of logic");
      return;
    }
    std::string missing;
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      if (!map_.hasOwnWire(signal)) continue;
      if (const auto bit = channelOf(signal)) {
        signals_.push_back(signal);
        bits_.push_back(*bit);
      } else if (needed(signal)) {
        const auto named = std::ranges::find(names_, signal, &ChannelNames::value_type::first);
        missing += (missing.empty() ? "" : ", ") + std::string(signalName(signal)) +
                   (named == names_.end() ? "" : " ('" + named->second + "')");
      }
    }
    if (missing.empty()) return;
    std::string there;
    for (const auto& [bit, name] : metadata_.channels) there += " '" + name + "'";
    faults_.push_back(fmt::format("no channel for {}; there are{}", missing, there));
  }

  void findParts() {
    if (metadata_.samples_name.empty()) return;
    std::uint64_t bytes = 0;
    const auto take = [&](const std::string& part) {
      const auto size = zip_.sizeOf(part);
      if (!size) return false;
      parts_.push_back(part);
      bytes += std::min(*size, kMostSampleBytes);
      return true;
    };
    if (!take(metadata_.samples_name)) {
      for (unsigned i = 1; take(fmt::format("{}-{}", metadata_.samples_name, i)); ++i) {
      }
    }
    // Some that are missing in the middle would shift all that follows in time.
    const std::string begin = metadata_.samples_name + "-";
    const auto there =
        std::ranges::count_if(zip_.names(), [&](const std::string& name) { return name.starts_with(begin); });
    if (parts_.empty() ||
        (parts_.front() != metadata_.samples_name && std::cmp_greater(there, parts_.size())))
      faults_.push_back(fmt::format("no part '{}-{}' with samples: the file is truncated",
                                    metadata_.samples_name, parts_.size() + 1));
    bytes_ = bytes;
    if (bytes > kMostSampleBytes) faults_.emplace_back("more than 64 GiB of samples");
    if (metadata_.sample_bytes > 0 && bytes % metadata_.sample_bytes != 0)
      faults_.emplace_back("ends with half a sample: it is truncated");
    if (!parts_.empty() && bytes == 0) faults_.emplace_back("has no samples");
  }

  PinRecording record() {
    base::ShareProgress progress(progress_, "reading " + std::filesystem::path(path_).filename().string(),
                                 bytes_);
    SamplePacker packer(bits_);
    RunRecorder recorder(signals_, map_);
    std::vector<std::uint8_t> rest;  // Begin of a sample that goes on in the next block.
    std::vector<LevelRun> runs;
    const auto take = [&](std::span<const std::uint8_t> whole) {
      packer.add(whole, metadata_.sample_bytes, runs);
      for (const LevelRun& run : runs) recorder.add(run);
      runs.clear();
    };
    std::uint64_t done = 0;
    for (const std::string& part : parts_) {
      zip_.read(part, [&](std::span<const std::uint8_t> block) {
        progress.done(done += block.size());
        if (!rest.empty()) {
          const std::size_t missing = std::min(metadata_.sample_bytes - rest.size(), block.size());
          rest.insert(rest.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(missing));
          block = block.subspan(missing);
          if (rest.size() < metadata_.sample_bytes) return;
          take(rest);
          rest.clear();
        }
        const std::size_t whole = block.size() / metadata_.sample_bytes * metadata_.sample_bytes;
        take(block.first(whole));
        rest.assign(block.begin() + static_cast<std::ptrdiff_t>(whole), block.end());
        if (recorder.edges() > kMostSampledEdges) throw std::runtime_error(path_ + ": " + kTooManyEdgesWords);
      });
    }
    PinRecording recording = recorder.takeRecording(metadata_.samplerate_hz,
                                                    {.origin = 0, .start = 0, .end = recorder.samples() - 1});
    readProblems(recording);
    return recording;
  }

  void readProblems(PinRecording& recording) const {
    if (!zip_.sizeOf(sr_parts::kProblems)) return;
    const std::string text = zip_.text(sr_parts::kProblems, kMostText);
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(at, end - at);
      // What cannot be read is a problem all the same.
      recording.problems.push_back(fromVcdWords(line).value_or(line));
      at = end + 1;
    }
  }

  std::string path_;
  const SignalMap& map_;
  const ChannelNames& names_;
  const base::ProgressFn& progress_;
  ZipReader zip_;
  std::vector<std::string> faults_;
  SrMetadata metadata_;
  std::vector<Signal> signals_;
  std::vector<unsigned> bits_;
  std::vector<std::string> parts_;
  std::uint64_t bytes_{};  ///< Bytes of all samples.
};

}  // namespace

PinRecording readSr(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
                    const base::ProgressFn& progress) {
  return SrReader(path, map, names, progress).read();
}

}  // namespace kerfbench::source
