// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerfbench::source {

/// Answers of the stand-in for libgpiod: its functions are linked instead of the library's.
struct FakeLine {
  std::string name;
  std::string consumer;
  bool used{};
  bool output{};
  bool active_low{};
};
struct FakeLibgpiod {
  int open_error{};
  int info_error{};          ///< Error of a chip's information; 1.6 reads it when the chip is opened.
  int line_error{};          ///< Error of the last line.
  std::string label{"sim"};  ///< Label of each chip; its name is that of the file.
  std::vector<FakeLine> lines;
  int open_chips{};  ///< Number of open chips and of all other objects that must be freed.
};
extern FakeLibgpiod fake_libgpiod;

}  // namespace kerfbench::source
