// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hil/base/spilled_vector.h"
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

  /// What lies before this time may leave the memory: it is read again from a file if it is asked for.
  void passed(double time_s) const;

  /// Each takes 8 bytes of a temporary file, 0.3 GB an hour.
  static constexpr double kRaster_s = 1e-4;

 private:
  [[nodiscard]] std::size_t indexAt(double time_s) const;

  base::SpilledVector<Steps> steps_;  ///< At the end of each raster period.
};

}  // namespace kerfbench::evidence
