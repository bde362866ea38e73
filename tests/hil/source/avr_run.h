// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tests/hil/source/run_source.h"

namespace kerfbench::source {

inline constexpr Tick kMs = 16'000;  ///< Ticks of a 16 MHz controller.
inline constexpr PinId kPA0{0, 0};

inline ChildSourceOptions avrOptions(std::string_view firmware, std::string_view mcu = "atmega2560") {
  ChildSourceOptions options;
  options.child = KERFBENCH_AVR_CHILD;
  options.image =
      std::string(KERFBENCH_IMAGES) + "/" + std::string(firmware) + "-" + std::string(mcu) + ".hex";
  options.mcu = mcu;
  return options;
}

inline Run runAvr(std::string_view firmware, Tick until, Tick quantum = kMs / 2) {
  const auto source = openChild(avrOptions(firmware));
  return runSource(*source, until, quantum);
}

}  // namespace kerfbench::source
