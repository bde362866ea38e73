// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

/// A return that is a jump: handlers of instructions call one another in a chain as long as the run is.
/// clang++ promises it; g++ does it because it optimises (see the CMakeLists.txt of the emulators).
#if defined(__clang__)
#define KERFBENCH_TAIL [[clang::musttail]]
#else
#define KERFBENCH_TAIL
#endif
