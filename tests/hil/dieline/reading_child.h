// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace kerfbench::dieline {

/// What became of a program that read one drawing.
struct ReadingChild {
  int exit_code{};  ///< -1 if a signal ended it.
  double cpu_s{};   ///< User and system time together.
  double peak_mib{};
  std::string said;  ///< What it wrote, standard error included.
};

/// Reads a drawing in a process of its own, measure-drawings beside the test, which may take 10 s of a
/// processor.
ReadingChild readInChild(const std::filesystem::path& path);

/// True if the child's build has a sanitizer, whose own memory and time count.
bool childIsWatched();

/// Expects that a file is refused with one line that holds `sentence`, within `most_s` of a processor and
/// `most_mib`.
void expectRefusedInTime(const std::filesystem::path& path, const std::string& name,
                         const std::string& sentence, double most_mib = 256, double most_s = 1);

}  // namespace kerfbench::dieline
