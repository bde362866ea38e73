// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "twin/base/pin_event.h"

namespace kerfbench {

/// Meaning of a pin. Outputs of the controller come first, its inputs (sensors) after them.
enum class Signal : std::size_t {
  kGalvoXPul,
  kGalvoXDir,
  kGalvoYPul,
  kGalvoYDir,
  kGantryXPul,
  kGantryXDir,
  kGantryYPul,
  kGantryYDir,
  kFeedPul,
  kFeedDir,
  kLaserGate,     ///< Laser enable; high, or by its machine low: the laser may emit.
  kLaserPwm,      ///< Power demand u in 0…1, as the share of time at the active level.
  kGalvoXEnable,  ///< Enables of drives, in the order of their PULs; several may have one pin.
  kGalvoYEnable,
  kGantryXEnable,
  kGantryYEnable,
  kFeedEnable,
  kEncoderA,
  kEncoderB,   ///< Quadrature of the belt's roller; A leads B when the belt runs along +Wx.
  kPrintMark,  ///< Print-mark sensor; high while a printed eye mark is under it.
  kLimitX,
  kLimitY,        ///< Limit switch; high at the end of travel of the gantry.
  kInterlock,     ///< Guard; high: closed, the laser may be armed.
  kPowerMonitor,  ///< Power meter; toggles for each quantum of energy that the laser has emitted.
  kStart,         ///< Start button; high: pressed.
  kCount
};
inline constexpr std::size_t kSignalCount = static_cast<std::size_t>(Signal::kCount);

/// True for a pin that the bench drives (a sensor), false for one that the controller drives.
constexpr bool isSensor(Signal signal) { return signal >= Signal::kEncoderA && signal < Signal::kCount; }

/// True for the enable of a drive.
constexpr bool isEnable(Signal signal) {
  return signal >= Signal::kGalvoXEnable && signal <= Signal::kFeedEnable;
}
/// Enable of the drive whose PUL this is.
constexpr Signal enableOf(Signal pul) {
  return static_cast<Signal>(static_cast<std::size_t>(Signal::kGalvoXEnable) +
                             static_cast<std::size_t>(pul) / 2);
}
static_assert(enableOf(Signal::kGalvoYPul) == Signal::kGalvoYEnable);
static_assert(enableOf(Signal::kFeedPul) == Signal::kFeedEnable);

/// Name of a signal in machine files, VCD files and reports, e.g. "galvo_x_pul".
std::string_view signalName(Signal signal);
std::optional<Signal> signalFromName(std::string_view name);

/// Assignment of signals to pins; a signal without a pin is not wired.
class SignalMap {
 public:
  void assign(Signal signal, PinId pin) { pins_.at(static_cast<std::size_t>(signal)) = pin; }
  [[nodiscard]] std::optional<PinId> pin(Signal signal) const {
    return pins_.at(static_cast<std::size_t>(signal));
  }
  /// True for a signal with a pin that none before it has. One pin may enable several drives: recordings and
  /// real lines have it once, as the first of them.
  [[nodiscard]] bool hasOwnWire(Signal signal) const;

 private:
  std::array<std::optional<PinId>, kSignalCount> pins_{};
};

/// Level that the bench puts on an input pin of the controller.
struct SensorEdge {
  Tick tick{};
  Signal signal{};
  bool level{};
};

}  // namespace kerfbench
