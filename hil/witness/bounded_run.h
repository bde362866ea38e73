// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace kerfbench::witness {

/// What a child may take. All are generous for a drawing that people made, and none is a measure of speed.
struct RunLimits {
  int cpu_s{300};                         ///< Seconds of processor, by the kernel (RLIMIT_CPU).
  double deadline_s{1800.0};              ///< Seconds of the clock, for a child that waits for ever.
  std::size_t memory_bytes{2ULL << 30U};  ///< Address space, by the kernel (RLIMIT_AS).
  std::size_t output_bytes{16U << 20U};   ///< What it may print.
};

/// How a child ended, and what it printed.
struct BoundedOutput {
  std::string output;  ///< Standard output.
  std::string trouble;  ///< Why it is of no use, a part of a sentence ("ended with exit status 1: …"); empty:
                        ///< it ended well.
  bool could_start{true};  ///< False where there is no such program.
};

/// Runs a program with an environment of its own, without input, and stops it and its children at the limits.
/// @throws std::system_error if the kernel gives no pipe or process.
BoundedOutput runBounded(const std::vector<std::string>& command, const RunLimits& limits);

}  // namespace kerfbench::witness
