// SPDX-License-Identifier: Apache-2.0
// The main program of every target: libFuzzer's own, around the reader that KERFBENCH_FUZZ_READER names.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)kerfbench::fuzz::KERFBENCH_FUZZ_READER({data, size});
  return 0;
}
