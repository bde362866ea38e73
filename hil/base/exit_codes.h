// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::base {

inline constexpr int kExitBroken = 2;    ///< The bench itself broke.
inline constexpr int kExitUsage = 64;    ///< Wrong command line.
inline constexpr int kExitInput = 65;    ///< Bad input file.
inline constexpr int kExitWaiting = 75;  ///< Somebody has to do something; then again.

/// Exit code of several runs: the worst of two.
int worstExitCode(int a, int b);

}  // namespace kerfbench::base
