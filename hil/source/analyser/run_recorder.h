// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

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
  /// Recording of the capture so far, at `samplerate_hz`.
  [[nodiscard]] PinRecording recording(std::uint64_t samplerate_hz, const Cut& cut) const;

 private:
  void event(std::uint64_t sample, std::uint32_t changed, std::uint32_t levels);

  std::vector<Signal> signals_;
  std::vector<PinId> pins_;
  std::optional<std::uint32_t> levels_;
  std::uint32_t first_levels_{};
  std::uint64_t samples_{};
  std::uint64_t edges_{};
  std::uint64_t first_edge_{};
  std::uint64_t last_edge_{};
  std::map<std::uint16_t, std::uint16_t> port_levels_;
  std::vector<PinEvent> start_;    ///< Events that stand for the first sample's levels.
  std::vector<PinEvent> outputs_;  ///< Events of the outputs by sample.
  std::vector<SensorEdge> sensors_;
};

}  // namespace kerfbench::source
