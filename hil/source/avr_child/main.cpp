// SPDX-License-Identifier: GPL-3.0-or-later
// kerfbench-avr: runs an AVR release image under simavr and speaks the pin-stream protocol on file
// descriptors 0 and 1.
#include <memory>

#include "hil/source/avr_child/controllers.h"
#include "hil/source/avr_child/machine.h"
#include "hil/source/emulator/run_child.h"

#ifdef KERFBENCH_SANITIZED
// simavr frees little of what it takes; the end of this process frees it all. A leak of our own is still
// told. NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name for it
extern "C" const char* __lsan_default_suppressions() { return "leak:libsimavr\n"; }
#endif

int main() {
  using namespace kerfbench;
  return emulator::runChild(
      "kerfbench-avr",
      [](const emulator::OpenRequest& asked) { return std::make_unique<avr_child::Machine>(asked); },
      avr_child::describeControllers);
}
