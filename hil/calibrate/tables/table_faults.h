// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace kerfbench::calibrate {

/// Every fault of a table's file, one a line as "name:line: …" (text) or "name: byte N: …" (binary).
class TableFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Faults of a file, as many as anybody wants to read.
class TableFaults {
 public:
  explicit TableFaults(std::string name) : name_(std::move(name)) {}
  void atLine(std::size_t line, const std::string& what) { add(":" + std::to_string(line) + ": " + what); }
  void atByte(std::size_t byte, const std::string& what) {
    add(": byte " + std::to_string(byte) + ": " + what);
  }
  void ofFile(const std::string& what) { add(": " + what); }
  [[nodiscard]] bool any() const { return count_ > 0; }
  /// @throws TableFileError if there is a fault.
  void throwIfAny() const {
    if (any()) raise();
  }
  /// Ends the reading after a fault. @throws TableFileError
  [[noreturn]] void raise() const;

 private:
  void add(const std::string& what);

  std::string name_;
  std::string text_;
  std::size_t count_{};
};

}  // namespace kerfbench::calibrate
