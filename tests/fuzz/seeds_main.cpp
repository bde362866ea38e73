// SPDX-License-Identifier: Apache-2.0
// Writes the sound inputs of the tests as seeds: fuzz_seeds FOLDER.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/sound_inputs.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    (void)std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 64;
  }
  for (const auto& [name, bytes] : kerfbench::fuzz::soundInputs()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / name;
    std::filesystem::create_directories(folder);
    std::ofstream file(folder / "sound", std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) return 2;
  }
  return 0;
}
