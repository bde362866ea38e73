// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace kerfbench::twin {

/// Divergence of the model: its numbers are out of bounds, so its run says nothing about a firmware.
class DivergenceError : public std::runtime_error {
 public:
  DivergenceError(double time_s, const std::string& joint)
      : std::runtime_error("the model diverges at " + std::to_string(time_s) + " s: " + joint),
        time_s_(time_s),
        joint_(joint) {}
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] const std::string& joint() const { return joint_; }

 private:
  double time_s_;
  std::string joint_;
};

}  // namespace kerfbench::twin
