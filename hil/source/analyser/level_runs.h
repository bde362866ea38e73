// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kerfbench::source {

/// Run of samples with the same levels; bit i is the i-th requested channel.
struct LevelRun {
  std::uint64_t samples{};
  std::uint32_t levels{};
  friend constexpr bool operator==(const LevelRun&, const LevelRun&) = default;
};
inline constexpr std::size_t kMostChannels = 32;

/// Packs samples, as sigrok has them (a fixed number of bytes each, little-endian), into runs.
class SamplePacker {
 public:
  /// `bits`: where each channel is in a sample; at most kMostChannels.
  /// @throws std::invalid_argument for more.
  explicit SamplePacker(std::vector<unsigned> bits);

  /// Appends the runs of whole samples; the last may go on in the next call. Levels do not differ between
  /// runs for what other channels do.
  /// @throws std::invalid_argument: not 1 … 8 bytes a sample, or too few for a channel, or half a sample.
  void add(std::span<const std::uint8_t> samples, std::size_t sample_bytes, std::vector<LevelRun>& runs);

 private:
  [[nodiscard]] std::uint32_t levelsOf(std::uint64_t sample) const;
  /// Takes a sample that is not as the one before; the run before it is `count` long.
  void change(std::uint64_t sample, std::uint64_t& count, std::vector<LevelRun>& runs);
  template <class Sample>
  void addWords(std::span<const std::uint8_t> samples, std::vector<LevelRun>& runs);

  std::vector<unsigned> bits_;
  /// Levels that each value of each byte of a sample stands for.
  std::vector<std::array<std::uint32_t, 256>> levels_of_byte_;
  std::optional<std::uint64_t> last_;
  std::uint32_t levels_{};
};

/// End of a capture.
struct ListenFor {
  std::uint64_t quiet_samples{};  ///< Silence after the first edge that ends it; > 0.
  std::uint64_t limit_samples{};  ///< Most samples of the whole capture; > 0.
};

/// Cuts a stream of runs off at the sample at which it is over, so that the same pins give the same recording
/// whatever size the packets of a device have.
class Listener {
 public:
  enum class State { kListening, kQuiet, kLimit };
  explicit Listener(const ListenFor& listen) : listen_(listen) {}

  /// Shortens or drops what comes too late.
  State add(std::vector<LevelRun>& runs);
  [[nodiscard]] std::uint64_t samples() const { return samples_; }

 private:
  ListenFor listen_;
  State state_{State::kListening};
  std::uint64_t samples_{};
  std::uint64_t since_edge_{};
  std::optional<std::uint32_t> levels_;
  bool any_edge_{};
};

}  // namespace kerfbench::source
