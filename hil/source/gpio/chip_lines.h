// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// Owner of a line, as the kernel reports it to others.
inline constexpr char kGpioConsumer[] = "kerfbench";

/// Line of a chip by its number there, with its name for people ("galvo_x_pul").
struct ChipLine {
  std::uint32_t offset{};
  std::string name;
};

/// Opens a chip of which these lines will be requested by the kernel's second interface.
/// @throws GpioError: chip missing, no gpiochip, not allowed, kernel without the second interface, every line
/// that is taken (and by whom), a line beyond the chip.
GpioFd openChipLines(const std::shared_ptr<GpioSystem>& system, const std::string& chip,
                     const std::vector<ChipLine>& lines);

}  // namespace kerfbench::source
