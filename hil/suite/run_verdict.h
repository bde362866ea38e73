// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::suite {

/// What verdict.json of a run says, as far as a release test needs it.
struct RunVerdict {
  std::string verdict;  ///< "PASS", "FAIL", "NOT PROVEN", "INVALID".
  int exit_code{};
  std::string summary;
  std::string likely_cause;
  std::string digest, inputs_digest;
  std::string firmware, firmware_sha256;
  std::uint64_t seed{};
  std::string imperfections, twin;
  double virtual_s{};
  std::vector<inspect::Check> checks;     ///< Without their guard bands and chances.
  std::vector<std::string> problems;      ///< Why the evidence cannot be trusted.
  std::vector<std::string> reservations;  ///< What the verdict is not to be read without.
};

/// Reads the verdict in a results folder. @throws base::InputError that names the file: it is not there, is
/// no verdict, or one of another version.
RunVerdict readRunVerdict(const std::filesystem::path& results);

/// The check that came nearest to its limit, of those with an upper limit > 0; null: there is none.
const inspect::Check* nearestToLimit(const RunVerdict& verdict);
/// "0.0312 mm ± 0.0040 mm (limit 0.0500 mm)", "4.50 µs (limit ≥ 0.00 µs)"; what is counted has no
/// uncertainty.
std::string figuresOf(const inspect::Check& check);

}  // namespace kerfbench::suite
