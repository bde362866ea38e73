// SPDX-License-Identifier: Apache-2.0
// kerfbench-cortex-m: runs an image for an STM32F103 and speaks the pin-stream protocol on file
// descriptors 0 and 1.
#include <memory>

#include "hil/source/cortex_m_child/machine.h"
#include "hil/source/cortex_m_child/parts.h"
#include "hil/source/emulator/run_child.h"

int main() {
  using namespace kerfbench;
  return emulator::runChild(
      "kerfbench-cortex-m",
      [](const emulator::OpenRequest& asked) { return std::make_unique<cortex_m_child::Machine>(asked); },
      cortex_m_child::describeParts);
}
