// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// A line of a chip, as the kernel knows it.
struct GpioLineInfo {
  std::uint32_t offset{};
  std::string name;      ///< Empty: it has none.
  std::string consumer;  ///< Who uses it; may be empty although `used`.
  bool used{};
  bool output{};
  bool active_low{};
};

struct GpioChipInfo {
  std::filesystem::path path;  ///< "/dev/gpiochip0".
  std::string name;            ///< "gpiochip0".
  std::string label;           ///< "pinctrl-bcm2711"; of the driver, may not be unique.
  std::vector<GpioLineInfo> lines;
};

/// Every gpiochip below `dev`, by number, and in words what is wrong with those that cannot be read.
struct GpioChipList {
  std::vector<GpioChipInfo> chips;
  std::vector<std::string> faults;
};
GpioChipList listChips(const std::filesystem::path& dev = "/dev");

/// A chip by its device file. @throws GpioError.
GpioChipInfo readChip(const std::filesystem::path& path);

/// The chip whose path, name or label this is. @throws GpioError: none, or more than one of this label.
const GpioChipInfo& findChip(const GpioChipList& list, const std::string& which);

/// The line of this number or, if it is none, of this name. @throws GpioError: none, or two of this name.
const GpioLineInfo& findLine(const GpioChipInfo& chip, const std::string& which);

}  // namespace kerfbench::source
