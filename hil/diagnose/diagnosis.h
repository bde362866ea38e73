// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/diagnose/evidence.h"

namespace kerfbench::diagnose {

/// A quantity with its expanded uncertainty (k = 2).
struct Size {
  double value{};
  double U{};
  std::string unit;
};

/// Something that is wrong with a release, a machine or a job.
struct Cause {
  /// What: one of causeKeys(), the same for programs at all times.
  std::string key;
  Size size;
  /// Share of the deviation of the cut that it explains, 0 … 1; NaN where it moves no line (a gate that is
  /// late).
  double share{kUnknown};
  double left_mm{kUnknown};  ///< RMS of the deviation that is left.
  bool direct{};             ///< Seen in pins, words or pictures, not fitted to deviations.
  double score{};            ///< Gain in chi square less the penalty of its parameters; for the order.
  std::vector<std::string>
      instead;           ///< Causes that explain it as well: they cannot be told apart in this run.
  std::string sentence;  ///< For people: what it is, how large, what to check.
};

/// Causes of a bad cut, the most likely first.
struct Diagnosis {
  std::vector<Cause> causes;
  double deviation_mm{kUnknown};  ///< RMS of the deviation that is to be explained.
  /// Sentence of the first cause if it explainsMost(); else where the deviation arises; empty: nothing to
  /// say.
  std::string sentence;
  /// Where nearly all of the deviation arises, and what to look at there, if no cause explainsMost(); or
  /// empty.
  std::string arises;
};

/// Whether a cause is the answer to why: it was seen itself, or explains at least half of the deviation.
bool explainsMost(const Cause& cause);

/// Compares the evidence with what each known cause would make of it. Pure. Of a run that has passed nothing
/// is said. Direct evidence goes before what fits; a second cause is named if it explains what the first
/// leaves.
Diagnosis diagnose(const Evidence& evidence);

/// All keys that Cause::key can have.
const std::vector<std::string>& causeKeys();

}  // namespace kerfbench::diagnose
