// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

namespace kerfbench::emulator {

/// Gives up, for good, everything that a loaded image does not need to run: all descriptors but standard
/// error and the two given, capabilities, and every system call besides reading and writing what is open,
/// anonymous memory that is not executable, waiting, and ending. Anything else ends the process at once by
/// SIGSYS. Standard output must go to standard error; both are unbuffered afterwards.
/// To be called while there is one thread. @throws std::runtime_error if the kernel refuses: then the image
/// must not run.
void enterSandbox(int in_fd, int out_fd);

}  // namespace kerfbench::emulator
