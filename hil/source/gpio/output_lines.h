// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/gpio/chip_lines.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// Lines of one chip as outputs, in one request of the kernel's second interface, so that lines which change
/// together do so in one call. The kernel lets go of them when this is destroyed; what level they keep then
/// is the chip's affair.
class OutputLines {
 public:
  /// Takes the lines, with these levels from the first moment on. @throws GpioError: as openChipLines();
  /// lines that cannot be outputs; not 1 to 64 of them.
  OutputLines(std::shared_ptr<GpioSystem> system, const std::filesystem::path& chip,
              std::vector<ChipLine> lines, const std::vector<bool>& levels);

  struct Change {
    std::size_t line{};  ///< Index among the lines that were asked for.
    bool level{};
  };
  /// Puts out all changes at once; of two of one line the last. @throws GpioError when the chip has gone.
  void set(const std::vector<Change>& changes);
  [[nodiscard]] const std::vector<ChipLine>& lines() const { return lines_; }

 private:
  std::shared_ptr<GpioSystem> system_;
  std::string chip_;
  std::vector<ChipLine> lines_;
  GpioFd chip_fd_;
  GpioFd fd_;
};

}  // namespace kerfbench::source
