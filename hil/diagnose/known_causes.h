// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/stage_fit.h"

namespace kerfbench::diagnose {

/// A cause that moves lines of the cut, and what to say of it.
struct KnownCause {
  std::string key;
  Hypothesis hypothesis;
  /// Signatures whose sizes make up its own: one, or the two components of a vector.
  std::vector<std::string> size_of;
  double factor{1.0};  ///< From the signature's unit to `unit`.
  std::string unit;
  /// "Encoder scale 0.40 ± 0.02 % too small", by the signed sizes of size_of in `unit`, and their U.
  std::function<std::string(const std::vector<double>& sizes, double U)> what;
  /// What to look at, a clause.
  std::function<std::string(const std::vector<double>& sizes)> advice;
  /// Relative standard uncertainty of its size by what its signature leaves out.
  double model{};
  bool only_positive{};  ///< Nothing has less than none of it: play, axes that give way.
};

/// All of them for a machine, the plainer before what looks alike.
std::vector<KnownCause> knownCauses(const Evidence& evidence);

/// Number and U with as many digits as U is worth: "0.40 ± 0.02".
std::string withU(double value, double U);

}  // namespace kerfbench::diagnose
