// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerfbench::dieline {

/// Collects everything wrong with one file, so that a user mends it in one go.
class FaultList {
 public:
  explicit FaultList(std::string path) : path_(std::move(path)) {}

  /// Notes a fault at a line (0: the file as a whole). The same fault twice (a block inserted twice) counts
  /// once.
  void add(int line, const std::string& message);
  [[nodiscard]] bool empty() const { return faults_.empty(); }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// @throws DielineError with all faults if there is one.
  void throwIfAny() const;
  /// Adds the fault and throws: reading on would make no sense.
  [[noreturn]] void fatal(int line, const std::string& message);

 private:
  std::string path_;
  std::vector<std::string> faults_;
  std::size_t dropped_{};
};

}  // namespace kerfbench::dieline
