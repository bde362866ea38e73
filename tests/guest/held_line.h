// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace kerfbench::guest {

/// A line that another program has, as an input.
class HeldLine {
 public:
  /// @throws std::system_error with the chip.
  HeldLine(const std::filesystem::path& chip, std::uint32_t line, const std::string& consumer);
  ~HeldLine();
  HeldLine(const HeldLine&) = delete;
  HeldLine& operator=(const HeldLine&) = delete;

 private:
  int fd_;
};

}  // namespace kerfbench::guest
