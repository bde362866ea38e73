// SPDX-License-Identifier: Apache-2.0
// kerfbench-mcs51: runs an image for an 8051 or one of its kin and speaks the pin-stream protocol on file
// descriptors 0 and 1.
#include <memory>

#include "hil/source/emulator/run_child.h"
#include "hil/source/mcs51_child/machine.h"
#include "hil/source/mcs51_child/part.h"

int main() {
  using namespace kerfbench;
  return emulator::runChild(
      "kerfbench-mcs51",
      [](const emulator::OpenRequest& asked) { return std::make_unique<mcs51_child::Machine>(asked); },
      mcs51_child::describeControllers);
}
