// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "twin/base/signal_map.h"

namespace kerfbench::scenario {

/// Section `provoke` of a scenario: what is to go wrong, so that the controller must end in a safe state.
struct ProvokeChoice {
  enum class Cause {
    kNone,
    kInterlock,     ///< The guard opens, for a while.
    kLimit,         ///< An end-of-travel switch closes, and stays so.
    kEncoder,       ///< Wires of the encoder break: the last level stays.
    kUartSilent,    ///< Nothing of the host arrives, from the middle of a frame on.
    kUartNoise,     ///< A share of the host's bytes is damaged.
    kHostStarves,   ///< The host has a part of the program only.
    kMarksFlicker,  ///< The print mark sensor flickers, once a millisecond.
    kBeltTooFast,   ///< The line runs away (belt.profile says how).
    kFieldLeft      ///< The line takes a gantry's job out of the field (belt.profile says how).
  };
  Cause cause{Cause::kNone};
  double at_s{};  ///< Time of the cause; not for those of host and line speed.
  double open_for_s{0.02};
  std::string limit{"x"};
  std::string encoder_lines{"both"};
  double share{};      ///< Share of bytes damaged, or of the program that the host has.
  std::string expect;  ///< Name of the fault to be reported; empty: what fits the cause.
};

/// A print mark sensor that flickers: a mark each.
inline constexpr double kFlicker_s = 1e-3;

/// Faults are noted in `provoke`.
ProvokeChoice readProvoke(base::YamlReader provoke, bool belt_is_followed);
/// The wires that it takes.
std::vector<Signal> signalsOf(const ProvokeChoice& choice);

}  // namespace kerfbench::scenario
