// SPDX-License-Identifier: Apache-2.0
#include "hil/app/release.h"

#include <fmt/format.h>

#include <cstdint>

#include "hil/source/open.h"

namespace kerfbench::hil {
namespace {

// Events in a quantum of 0.5 ms that no controller of a die-cutter makes: 2 million a second, 20 times what
// the reference controller makes with all axes at full speed.
constexpr std::uint64_t kFlood = 1000;

}  // namespace

std::unique_ptr<SignalSource> openRelease(const FirmwareChoice& firmware,
                                          const std::filesystem::path& bin_dir) {
  ChildSourceOptions options;
  options.image = firmware.image;
  // A native release is itself the child that speaks the protocol.
  options.child = firmware.source == FirmwareChoice::Source::kAvr      ? bin_dir / "kerfbench-avr"
                  : firmware.source == FirmwareChoice::Source::kNative ? firmware.image
                                                                       : firmware.child;
  options.mcu = firmware.mcu;
  options.clock_hz = firmware.clock_hz;
  options.baud = firmware.baud;
  options.max_events_per_quantum = kFlood;
  try {
    return openChild(options);
  } catch (const std::runtime_error& e) {
    throw InputFault(fmt::format("{}: {}", firmware.image.string(), e.what()));
  }
}

}  // namespace kerfbench::hil
