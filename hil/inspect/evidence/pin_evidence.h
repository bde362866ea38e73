// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::inspect {

/// An interval of the laser gate, as the pins showed it.
struct GateInterval {
  double on_s{};
  double off_s{};
};

/// A span of time in which a line was at one level.
struct Span {
  double from_s{};
  double to_s{};
};

/// An edge of the belt's encoder, as the pins showed it.
struct BeltEdge {
  double time_s{};
  double
      x_mm{};  ///< Travel of the belt since the start, by what the controller was told that a count is worth.
};

}  // namespace kerfbench::inspect
