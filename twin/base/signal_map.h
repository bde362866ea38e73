// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "twin/base/pin_event.h"

namespace kerfbench {

/// What a pin means. Outputs of the controller first, its inputs (sensors) after.
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
  kLaserGate,  ///< High: the laser may emit.
  kLaserPwm,   ///< Duty is the power demand u in 0…1.
  kEncoderA,
  kEncoderB,   ///< Quadrature of the belt's roller; A leads B when the belt runs along +Wx.
  kPrintMark,  ///< High while a printed eye mark is under the sensor.
  kLimitX,
  kLimitY,        ///< High at the end of travel of the gantry.
  kInterlock,     ///< High: guard closed, the laser may be armed.
  kPowerMonitor,  ///< Toggles for each quantum of energy that the laser has emitted.
  kCount
};
inline constexpr std::size_t kSignalCount = static_cast<std::size_t>(Signal::kCount);

/// True for a pin that the bench drives (a sensor), false for one that the controller drives.
constexpr bool isSensor(Signal signal) { return signal >= Signal::kEncoderA && signal < Signal::kCount; }

/// The name used in machine files, VCD files and reports, e.g. "galvo_x_pul".
std::string_view signalName(Signal signal);
std::optional<Signal> signalFromName(std::string_view name);

/// Which pin carries which signal; a signal without a pin is not wired.
class SignalMap {
 public:
  void assign(Signal signal, PinId pin) { pins_.at(static_cast<std::size_t>(signal)) = pin; }
  [[nodiscard]] std::optional<PinId> pin(Signal signal) const {
    return pins_.at(static_cast<std::size_t>(signal));
  }

 private:
  std::array<std::optional<PinId>, kSignalCount> pins_{};
};

/// A level that the bench puts on an input pin of the controller.
struct SensorEdge {
  Tick tick{};
  Signal signal{};
  bool level{};
};

}  // namespace kerfbench
