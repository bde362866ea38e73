// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_faults.h"

namespace kerfbench::calibrate {

namespace {
constexpr std::size_t kMostFaults = 20;
}

void TableFaults::add(const std::string& what) {
  if (++count_ <= kMostFaults) text_ += name_ + what + "\n";
}

void TableFaults::raise() const {
  std::string text = text_;
  if (count_ > kMostFaults) text += name_ + ": and " + std::to_string(count_ - kMostFaults) + " more\n";
  text.pop_back();
  throw TableFileError(text);
}

}  // namespace kerfbench::calibrate
