// SPDX-License-Identifier: Apache-2.0
#include "hil/run/release.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "firmware_under_test/planner/job/target.h"
#include "hil/base/installation.h"
#include "hil/source/open.h"

namespace kerfbench::run {
namespace {

// Events in a quantum of 0.5 ms that no controller of a die-cutter makes: 50 in each of the AVR release's
// ticks, 20 times what it makes with all axes at full speed. A faster controller makes no more than five in a
// tick of its own.
std::uint64_t flood(const scenario::FirmwareChoice& firmware) {
  constexpr double kQuantum_s = 0.5e-3;
  constexpr double kLeast = 1000.0;
  if (firmware.dialog != scenario::FirmwareChoice::Dialog::kKerfbench)
    return static_cast<std::uint64_t>(kLeast);
  const double tick_s = planner::findTarget(firmware.image).value_or(planner::Target{}).tick_s;
  return static_cast<std::uint64_t>(std::max(kLeast, 5.0 * kQuantum_s / tick_s));
}

}  // namespace

std::unique_ptr<source::SignalSource> openRelease(const scenario::FirmwareChoice& firmware,
                                                  const std::filesystem::path& bin_dir) {
  if (firmware.onRealPins())
    throw base::InputError("a scenario on real pins (source: gpio, analyser) runs by `kerfbench run` alone");
  source::ChildSourceOptions options;
  options.image = firmware.image;
  options.child = firmware.childIn(bin_dir);
  if (firmware.emulator() != nullptr && !std::filesystem::exists(options.child))
    throw base::InputError(fmt::format("{}: the emulator is not there: {}", options.child.string(),
                                       base::isInstalled(bin_dir)
                                           ? "install the package kerfbench-emulators"
                                           : "this build was made without its library"));
  options.mcu = firmware.mcu;
  options.eeprom = firmware.eeprom_blank ? std::string(source::kBlankEeprom) : firmware.eeprom.string();
  options.clock_hz = firmware.clock_hz;
  // Where nothing is spoken, the firmware may use its UART as it likes.
  options.baud = firmware.dialog == scenario::FirmwareChoice::Dialog::kNone ? 0 : firmware.baud;
  options.max_events_per_quantum = flood(firmware);
  options.confined = firmware.emulator() == nullptr;
  try {
    return source::openChild(options);
  } catch (const std::runtime_error& e) {
    throw base::InputError(fmt::format("{}: {}", firmware.image.string(), e.what()));
  }
}

}  // namespace kerfbench::run
