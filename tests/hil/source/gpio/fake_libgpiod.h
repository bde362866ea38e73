// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerfbench::source {

/// What the stand-in for libgpiod says: its functions are linked instead of the library's.
struct FakeLine {
  std::string name;
  std::string consumer;
  bool used{};
  bool output{};
  bool active_low{};
};
struct FakeLibgpiod {
  int open_error{};
  int info_error{};          ///< Of what a chip says of itself; 1.6 asks when it is opened.
  int line_error{};          ///< For the last line.
  std::string label{"sim"};  ///< Of each chip; its name is that of the file.
  std::vector<FakeLine> lines;
  int open_chips{};  ///< And whatever else is to be given back.
};
extern FakeLibgpiod fake_libgpiod;

}  // namespace kerfbench::source
