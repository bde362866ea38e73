// SPDX-License-Identifier: GPL-2.0-or-later
// kerfbench-cortex-m: runs an image for an STM32F103 under Unicorn and speaks the pin-stream protocol on file
// descriptors 0 and 1.
#include <cstdint>
#include <memory>

#include "hil/source/cortex_m_child/machine.h"
#include "hil/source/cortex_m_child/parts.h"
#include "hil/source/emulator/run_child.h"

int main() {
  using namespace kerfbench;
  // Unicorn sets 1 GiB aside for translated code, of which an image uses a few MiB.
  constexpr std::uint64_t kAddressSpace_bytes = std::uint64_t{3} << 30U;
  return emulator::runChild(
      "kerfbench-cortex-m",
      [](const emulator::OpenRequest& asked) { return std::make_unique<cortex_m_child::Machine>(asked); },
      cortex_m_child::describeParts, kAddressSpace_bytes);
}
