// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "hil/camera/twin/exposure_feed.h"
#include "hil/run/lockstep.h"
#include "hil/run/machine_film.h"
#include "hil/run/passing_web.h"
#include "hil/source/signal_source.h"
#include "twin/cutter/twin.h"

// Private to this room: whoever includes this holds a twin.

namespace kerfbench::run {

/// Who looks at the twin while it runs; null: nobody.
struct Onlookers {
  camera::ExposureFeed* exposures{};  ///< Gets the exposures as they end, which else stay with the twin.
  PassingWeb* web{};                  ///< Gets the web that has passed, which else stays with the twin.
};

/// The twin as such a machine. `twin` and onlookers must outlive it.
class TwinModel : public LockstepModel {
 public:
  explicit TwinModel(twin::Twin& twin, const Onlookers& onlookers = {})
      : twin_(twin), onlookers_(onlookers) {}
  std::vector<SensorEdge> predictSensors(Tick until) override { return twin_.predictSensors(until); }
  void advance(Tick until, std::span<const PinEvent> events) override {
    twin_.advance(until, events);
    if (onlookers_.exposures != nullptr) onlookers_.exposures->add(twin_.takeExposures());
    if (onlookers_.web != nullptr) onlookers_.web->look(twin_);
  }
  [[nodiscard]] double longestQuantum_s() const override { return twin_.longestQuantum_s(); }

 private:
  twin::Twin& twin_;
  Onlookers onlookers_;
};

/// The twin, and what its sensors did while it was led by recorded pins. `twin` must outlive it.
class WitnessedTwin final : public TwinModel {
 public:
  explicit WitnessedTwin(twin::Twin& twin, const Onlookers& onlookers = {}) : TwinModel(twin, onlookers) {}
  void advance(Tick until, std::span<const PinEvent> events) override {
    const std::vector<SensorEdge> edges = predictSensors(until);
    due_.append(edges);
    TwinModel::advance(until, events);
  }
  [[nodiscard]] const base::SpilledVector<SensorEdge>& due() const { return due_; }

 private:
  base::SpilledVector<SensorEdge> due_;
};

/// A source that is filmed: hands everything on, and takes a frame of the twin before each quantum.
class FilmedSource : public source::SignalSource {
 public:
  FilmedSource(source::SignalSource& source, const twin::Twin& twin, MachineFilm& film)
      : source_(source), twin_(twin), film_(film) {}

  [[nodiscard]] source::SourceInfo info() const override { return source_.info(); }
  source::Stop advance(Tick until, source::Batch& batch) override {
    film_.add(twin_);
    return source_.advance(until, batch);
  }
  void drive(PinId pin, bool level, Tick at) override { source_.drive(pin, level, at); }
  void uartWrite(std::span<const std::uint8_t> bytes) override { source_.uartWrite(bytes); }
  [[nodiscard]] std::string message() const override { return source_.message(); }

 private:
  source::SignalSource& source_;
  const twin::Twin& twin_;
  MachineFilm& film_;
};

}  // namespace kerfbench::run
