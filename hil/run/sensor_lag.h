// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/scenario.h"
#include "hil/source/gpio/lag_meter.h"
#include "hil/source/vcd.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::run {

/// How far the controller's inputs, as they were driven on real pins, are from those of the machine that is
/// judged. It is all that live driving adds: timers, calls, a model that ran ahead without the pins.
struct SensorLag {
  source::LagMeter
      lag;  ///< Driven less due, of the edges that have found each other; without limit switches.
  source::LagMeter switch_lag;  ///< Lag of these, which are as late as pins are known.
  std::vector<std::string>
      problems;  ///< Edges that were not driven in time, or that the machine did not make.
  std::vector<std::string> guard_problems;  ///< The same of the interlock.
};

/// Edges of a kind belong together: of the encoder those to the same count in the same direction, of others
/// those to the same level; of several the nearest. @param due by tick, of the machine as its pins moved it.
/// @param driven as `due`, as it was on the wires. Neither counts later than `limit_s` before `end`.
SensorLag sensorLag(const base::SpilledVector<SensorEdge>& due, const base::SpilledVector<SensorEdge>& driven,
                    TickRate rate, Tick end, const std::vector<Signal>& signals, double limit_s);

/// What an edge that is driven may be off its time: the scenario's, or what moves the sheet by 10 um at the
/// fastest speed of the line (1 us … 1 ms).
double sensorLagLimit_s(const scenario::Scenario& scenario);

}  // namespace kerfbench::run
