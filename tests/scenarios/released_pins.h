// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/analyser/level_runs.h"
#include "hil/source/vcd.h"
#include "tests/hil/source/gpio/scripted_kernel.h"
#include "twin/base/signal_map.h"

namespace kerfbench::test {

/// Pins of the native release's job on a sheet at rest, ten entities of the button, from a run of the
/// program; with the settings of a real controller's scenario of the same job.
class ReleasedPins {
 public:
  /// Runs the program. `planner`: section of the scenario, as "{faults: {no_pincushion: true}}". Files go to
  /// `folder`.
  ReleasedPins(const std::filesystem::path& folder, const std::string& name, const std::string& planner);

  [[nodiscard]] const source::PinRecording& recording() const { return recording_; }
  [[nodiscard]] const SignalMap& map() const { return map_; }
  /// Outputs that the job uses; a gpiochip's line or an analyser's channel has the index of its signal here.
  [[nodiscard]] static const std::vector<Signal>& wired();
  /// Writes a scenario of the same job with this section `firmware`. Returns its path.
  [[nodiscard]] std::filesystem::path scenario(const std::string& firmware) const;

  /// A kernel whose lines do what the pins did; edge number `merged` (from 1) never comes, 0: all do.
  [[nodiscard]] std::shared_ptr<source::ScriptedKernel> kernel(std::uint32_t merged = 0) const;

  /// Levels of wired() as an analyser of this rate samples them: half a second before the first edge and five
  /// behind the last, which is a run of its own.
  [[nodiscard]] std::vector<source::LevelRun> sampled(std::uint64_t samplerate_hz) const;

 private:
  std::filesystem::path folder_;
  std::string name_;
  std::string planner_;
  source::PinRecording recording_;
  SignalMap map_;
};

}  // namespace kerfbench::test
