// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "hil/source/signal_source.h"
#include "hil/source/vcd.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// Value of ChildSourceOptions::eeprom.
inline constexpr std::string_view kBlankEeprom = "blank";

/// A release image in a child process that speaks the pin-stream protocol (see pin_stream.h).
struct ChildSourceOptions {
  std::filesystem::path
      child;  ///< Emulator, native release, or any other program that speaks the protocol; or tcp:HOST:PORT.
  std::filesystem::path image;  ///< What the child runs; a native release is itself the child.
  std::string eeprom{};  ///< File with what the EEPROM holds, or "blank"; empty: what the image says of it.
  std::string mcu{"atmega2560"};
  std::uint64_t clock_hz{16'000'000};
  std::uint32_t baud{250'000};  ///< 0: nobody listens to its UART, and nothing is sent.
  std::uint64_t max_events_per_quantum{200'000};
  double hang_guard_s{20.0};  ///< Wall time for one quantum before the child is killed (kHung).
  /// Wall time in all that the bench waits for its answers before it is killed (kHung): so much, and so much
  /// for each second of simulated time.
  double patience_s{600.0}, patience_per_s{600.0};
  bool confined{};  ///< The child does not come with the bench: it runs in a Confinement.
};
/// @throws std::system_error if the child cannot be started, std::runtime_error if it refuses the image.
std::unique_ptr<SignalSource> openChild(const ChildSourceOptions& options);

/// Asks a child for the controller of a name, or for all that it emulates where none is called so, in the
/// words of DESCRIPTION in pin_stream.h. @throws std::runtime_error if it does not say.
std::string describeChild(const std::filesystem::path& child, const std::string& mcu);

/// Replays pins.vcd (or any VCD with 1-bit wires named as signalName()); `map` gives the pins the events get.
/// @throws std::runtime_error listing every fault with its line.
std::unique_ptr<SignalSource> openVcd(const std::filesystem::path& path, const SignalMap& map);

/// Replays a recording that is in memory; `config_id` says where it comes from.
std::unique_ptr<SignalSource> openRecording(PinRecording recording, std::string config_id);

}  // namespace kerfbench::source
