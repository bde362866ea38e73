// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::twin {

/// Collects faults of a description, each a sentence with the value and its unit. NaN is always a fault.
class FaultList {
 public:
  void require(bool fine, const std::string& fault) {
    if (!fine) faults_.push_back(fault);
  }
  /// Requires a value in [least, most].
  void within(const std::string& name, double value, double least, double most, const std::string& unit) {
    require(value >= least && value <= most,
            name + " must be in [" + text(least) + ", " + text(most) + "]" + is(value, unit));
  }
  /// Requires a value in (0, most].
  void positive(const std::string& name, double value, double most, const std::string& unit) {
    require(value > 0.0 && value <= most, name + " must be in (0, " + text(most) + "]" + is(value, unit));
  }
  /// Requires a value above zero; infinity stands for no limit.
  void limit(const std::string& name, double value, const std::string& unit) {
    require(value > 0.0, name + " must be > 0" + is(value, unit));
  }
  /// Takes over faults that another check has found, "a; b".
  void take(const std::string& where, const std::string& joined) {
    for (std::size_t begin = 0; begin < joined.size();) {
      const std::size_t end = std::min(joined.find("; ", begin), joined.size());
      faults_.push_back(where + joined.substr(begin, end - begin));
      begin = end + 2;
    }
  }
  [[nodiscard]] std::size_t size() const { return faults_.size(); }
  [[nodiscard]] std::vector<std::string> list() && { return std::move(faults_); }

  static std::string text(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
  }

 private:
  static std::string is(double value, const std::string& unit) {
    return (unit.empty() ? "" : " " + unit) + ", is " + text(value);
  }
  std::vector<std::string> faults_;
};

}  // namespace kerfbench::twin
