// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "hil/camera/machine_cameras.h"
#include "hil/run/dialog.h"
#include "hil/run/lockstep.h"
#include "hil/run/machine_film.h"
#include "hil/scenario/case.h"
#include "hil/source/signal_source.h"
#include "twin/camera/camera.h"
#include "twin/description/fidelity.h"
#include "twin/description/imperfections.h"

namespace kerfbench::twin {
class Sheet;
}

namespace kerfbench::camera {
class ExposureFeed;
}

namespace kerfbench::run {

struct ModelOptions {
  twin::Fidelity fidelity{twin::Fidelity::kReference};
  std::uint64_t seed{1};
  bool record_exposures{
      true};  ///< Off: the spot camera sees nothing. For runs of which only pictures are wanted.
  /// A real spot camera looks: exposures of the model only tell people where machine and model part. They are
  /// taken more often than by the model's own camera.
  bool beside_real_camera{false};
  /// Keeps which edges the machine's sensors were due to give while recorded pins led it.
  bool witness_sensors{false};
  Onlooker* onlooker{};  ///< Is shown the run; may be null, else it must outlive it.
};

/// What the model alone knows of a run. It tells people why; nothing that judges may use it.
struct ModelTruth {
  std::vector<twin::Imperfection> imperfections;
  std::vector<twin::LostSteps> lost_steps;
  std::vector<twin::Exposure> exposures;  ///< Only beside a real camera.
};

/// The modelled machine of one run. It moves as the pins say, is filmed meanwhile, and its cameras look at it
/// afterwards. The twin stays inside.
class ModelMachine final : public camera::MachineCameras {
 public:
  /// `sampled`: the machine that runs.
  /// @throws std::invalid_argument for a machine that cannot run.
  ModelMachine(scenario::Case test_case, twin::SampledMachine sampled, TickRate rate,
               const ModelOptions& options);
  ~ModelMachine() override;
  ModelMachine(const ModelMachine&) = delete;
  ModelMachine& operator=(const ModelMachine&) = delete;

  /// Lockstep with a source, once. `dialog` may be null, as for runLockstep().
  RecordedRun run(source::SignalSource& source, Dialog* dialog, const LockstepOptions& options,
                  const ProgressFn& progress);

  [[nodiscard]] const MachineFilm& film() const { return film_; }
  /// With `witness_sensors`: by tick.
  [[nodiscard]] const base::SpilledVector<SensorEdge>& dueSensors() const { return due_sensors_; }
  /// Takes the exposures away where they belong to it.
  ModelTruth truth();
  /// The sheet as it is now. @throws std::logic_error after kerfTilesMeanwhile(): its beginning is gone.
  const twin::Sheet& sheet();

  std::unique_ptr<camera::FrameSource> spotFrames(double from_s, double to_s, int threads) override;
  /// With it spotFrames() finds none. @throws std::logic_error after the first call.
  std::unique_ptr<camera::FramesMeanwhile> spotFramesMeanwhile(int threads) override;
  std::unique_ptr<camera::TileSource> kerfTiles(int threads) override;
  /// Null where units reach into each other. With it kerfTiles() must not be asked.
  /// @throws std::logic_error after the first call.
  std::unique_ptr<camera::TilesMeanwhile> kerfTilesMeanwhile(int threads, std::size_t most_waiting) override;

 private:
  [[nodiscard]] twin::SpotCamera spotCamera() const;
  /// The case with its marks where the sampled lot of board bears them: what cameras see, and nobody is told.
  [[nodiscard]] scenario::Case asPrinted() const;
  class Hidden;

  scenario::Case test_case_;
  twin::SampledMachine sampled_;
  ModelOptions options_;
  MachineFilm film_;
  base::SpilledVector<SensorEdge> due_sensors_;
  std::shared_ptr<camera::ExposureFeed> feed_;  ///< Null: nobody looks meanwhile.
  std::unique_ptr<Hidden> hidden_;
};

/// As the scenario asks for it.
ModelOptions modelOptions(const scenario::Case& test_case);

}  // namespace kerfbench::run
