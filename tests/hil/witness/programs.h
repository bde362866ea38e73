// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "hil/witness/witness.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::witness {

/// The second reader of this build.
inline WitnessProgram realWitness() {
  return witnessBeside(std::filesystem::path(KERFBENCH_BINARY_DIR) / "bin");
}

/// A program of a test in the second reader's place: text of a script with its first line.
class StandIn {
 public:
  explicit StandIn(const std::string& script) : file_("", script) {
    std::filesystem::permissions(file_.path(), std::filesystem::perms::owner_all);
  }
  [[nodiscard]] WitnessProgram program() const {
    WitnessProgram program;
    program.python = file_.path();
    program.script = file_.path();
    return program;
  }

 private:
  dieline::TempFile file_;
};

inline bool canImport(const std::string& library) {
  return std::system(("/usr/bin/python3 -c 'import " + library + "' 2>/dev/null").c_str()) == 0;
}

inline std::string allSentences(const Testimony& testimony) {
  std::string text;
  for (const std::string& sentence : testimony.sentences) text += sentence + "\n";
  return text;
}

}  // namespace kerfbench::witness
