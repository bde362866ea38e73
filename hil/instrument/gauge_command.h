// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"
#include "hil/gauge/gauge.h"

namespace kerfbench::instrument {

/// What gauge can be asked for.
inline constexpr std::array kGaugeStudies{"verdicts", "coverage", "type1", "grr", "stillness"};

/// See gaugeCommand().
struct GaugeCommandOptions {
  std::filesystem::path machine{"fixtures/machines/two-mirror.yaml"};
  std::filesystem::path results_dir{"results"};
  gauge::GaugeOptions gauge;
  std::vector<std::string> studies;  ///< Names of kGaugeStudies; none: all.
  std::string test_case;             ///< Name of one case to repeat; empty: all.
  std::string command_line;          ///< As typed, for the report.
  bool mismatch{};                   ///< GaugeSetup::mismatch
  bool quiet{};
};

/// Proves the cameras and the judge on artefacts with known deviation; writes gauge.json and gauge.html.
/// Returns 0 if no claim failed, 1 if one did, base::kExitInput. With a case named: repeats that alone, and
/// returns 0.
int gaugeCommand(const GaugeCommandOptions& options);

}  // namespace kerfbench::instrument
