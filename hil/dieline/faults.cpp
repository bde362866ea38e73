// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/faults.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {
constexpr std::size_t kMostFaults = 100;  // A broken file has one cause, not a million.
}

void FaultList::add(int line, const std::string& message) {
  std::string text =
      line > 0 ? fmt::format("{}:{}: {}", path_, line, message) : fmt::format("{}: {}", path_, message);
  if (std::find(faults_.begin(), faults_.end(), text) != faults_.end()) return;
  if (faults_.size() >= kMostFaults) {
    ++dropped_;
    return;
  }
  faults_.push_back(std::move(text));
}

void FaultList::throwIfAny() const {
  if (faults_.empty()) return;
  std::string text = fmt::format("{}", fmt::join(faults_, "\n"));
  if (dropped_ > 0) text += fmt::format("\n{}: and {} more", path_, dropped_);
  throw DielineError(text);
}

void FaultList::fatal(int line, const std::string& message) {
  add(line, message);
  throwIfAny();
  std::abort();  // Not reached: add() has just made the list non-empty.
}

}  // namespace kerfbench::dieline
