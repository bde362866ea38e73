// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerfbench::source {

/// Lag of edges behind their plan; later is positive.
class LagMeter {
 public:
  void add(std::int64_t lag_ns, std::uint64_t at_ns);
  [[nodiscard]] std::uint64_t edges() const { return edges_; }
  /// Furthest from the plan; of equals the first.
  [[nodiscard]] std::int64_t worst_ns() const { return worst_ns_; }
  [[nodiscard]] std::uint64_t worstAt_ns() const { return worst_at_ns_; }
  /// Root of the mean square; 0 without edges.
  [[nodiscard]] double rms_ns() const;

 private:
  std::uint64_t edges_{};
  std::int64_t worst_ns_{};
  std::uint64_t worst_at_ns_{};
  double squares_{};
};

}  // namespace kerfbench::source
