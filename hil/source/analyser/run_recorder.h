// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "hil/source/analyser/level_runs.h"
#include "hil/source/vcd.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// Runs of levels become events of ports. Equal runs in a row are one.
class RunRecorder {
 public:
  /// `signals`: on each channel; an output is an event of its port, a sensor an edge of its own.
  /// @throws std::invalid_argument for a signal that `map` does not have.
  RunRecorder(const std::vector<Signal>& signals, const SignalMap& map);

  void add(const LevelRun& run);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] std::uint64_t edges() const { return edges_; }
  /// Levels of the first sample.
  [[nodiscard]] std::uint32_t firstLevels() const { return first_levels_; }
  /// Samples of the first and the last edge; 0: there is none.
  [[nodiscard]] std::uint64_t firstEdge() const { return first_edge_; }
  [[nodiscard]] std::uint64_t lastEdge() const { return last_edge_; }

  /// Position of a recording in the capture.
  struct Cut {
    std::int64_t origin{};  ///< Sample of tick 0; not after the first edge.
    Tick start{};           ///< Time of the levels that are high at the start; before the first edge.
    Tick end{};
  };
  /// Recording of the capture, at `samplerate_hz`, which takes its events away.
  [[nodiscard]] PinRecording takeRecording(std::uint64_t samplerate_hz, const Cut& cut);

 private:
  void event(std::uint64_t sample, std::uint32_t changed, std::uint32_t levels);

  struct Channel {
    Signal signal{};
    bool is_sensor{};
    std::size_t port{};  ///< Index in ports_.
    std::uint16_t mask{};
  };
  struct Port {
    std::uint16_t number{};
    std::uint16_t level{};
    std::uint16_t changed{};  ///< Bits that the run changes which is being added.
  };
  void put(Port& port, std::uint64_t sample, std::uint16_t changed);

  std::vector<Channel> channels_;
  std::vector<Port> ports_;  ///< Sorted by number.
  std::optional<std::uint32_t> levels_;
  std::uint32_t first_levels_{};
  std::uint64_t samples_{};
  std::uint64_t edges_{};
  std::uint64_t first_edge_{};
  std::uint64_t last_edge_{};
  PinEvents outputs_;  ///< Sorted by sample; those of sample 0 stand for the first levels.
  base::SpilledVector<SensorEdge> sensors_;
};

}  // namespace kerfbench::source
