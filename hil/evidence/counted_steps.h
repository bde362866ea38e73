// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hil/evidence/pin_evidence.h"
#include "hil/source/vcd.h"

namespace kerfbench::evidence {

/// The steps of two axes that the pins have asked for, over time: DIR high counts up, as all drives of the
/// bench have it. Nothing says here whether a drive has followed.
class CountedSteps {
 public:
  using Steps = std::array<std::int32_t, 2>;

  /// Reads `recording.outputs` for the first two of `drives`. Nullopt if one of their lines is not wired.
  static std::optional<CountedSteps> of(const source::PinRecording& recording, const PinWiring& wiring);

  /// Steps at a time, s from tick 0: as they are at the end of its raster period.
  [[nodiscard]] Steps at(double time_s) const;

  /// The memory is 8 bytes for each of these.
  static constexpr double kRaster_s = 1e-4;

 private:
  std::vector<Steps> steps_{{0, 0}};  ///< At the end of each raster period.
};

}  // namespace kerfbench::evidence
