// SPDX-License-Identifier: Apache-2.0
#include "hil/run/model_machine.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hil/camera/twin/exposure_feed.h"
#include "hil/camera/twin/twin_frames.h"
#include "hil/run/cut_on_twin.h"
#include "hil/run/twin_model.h"

namespace kerfbench::run {
namespace {

// Between two exposures of the model beside a real camera.
constexpr double kDensePeriod_s = 250e-6;
// Exposures that wait for the spot camera while the machine runs: some 1.3 KiB each.
constexpr std::size_t kMostWaiting = 2048;

twin::MachineDescription watched(twin::MachineDescription machine, bool beside_real_camera) {
  twin::CameraDescription& camera = machine.spot_camera;
  if (beside_real_camera)
    camera.frame_period_s = std::min(camera.frame_period_s, std::max(camera.exposure_s, kDensePeriod_s));
  return machine;
}

twin::TwinOptions twinOptionsOf(const ModelOptions& options) {
  twin::TwinOptions result;
  result.fidelity = options.fidelity;
  result.seed = options.seed;
  result.record_exposures = options.record_exposures;
  return result;
}

}  // namespace

class ModelMachine::Hidden {
 public:
  Hidden(const scenario::Case& test_case, const twin::MachineDescription& machine, TickRate rate,
         const twin::TwinOptions& options)
      : twin(machine, scenario::webOn(machine, test_case), rate, options) {}
  twin::Twin twin;
};

ModelOptions modelOptions(const scenario::Case& test_case) {
  ModelOptions options;
  options.fidelity = test_case.scenario.fidelity;
  options.seed = test_case.scenario.seed;
  return options;
}

ModelMachine::ModelMachine(scenario::Case test_case, twin::SampledMachine sampled, TickRate rate,
                           const ModelOptions& options)
    : test_case_(std::move(test_case)),
      sampled_(std::move(sampled)),
      options_(options),
      film_(sampled_.machine.laser.full_power_w),
      hidden_(std::make_unique<Hidden>(test_case_, watched(sampled_.machine, options.beside_real_camera),
                                       rate, twinOptionsOf(options))) {}

ModelMachine::~ModelMachine() = default;

RecordedRun ModelMachine::run(source::SignalSource& source, Dialog* dialog, const LockstepOptions& options,
                              const ProgressFn& progress) {
  twin::Twin& twin = hidden_->twin;
  FilmedSource filmed(source, twin, film_);
  TwinModel alone(twin, feed_.get());
  WitnessedTwin witnessed(twin, feed_.get());
  LockstepModel& model = options_.witness_sensors ? static_cast<LockstepModel&>(witnessed) : alone;
  RecordedRun result = runLockstep(filmed, model, test_case_.machine.signals, dialog, options, progress);
  film_.add(twin);
  due_sensors_ = witnessed.due();
  return result;
}

ModelTruth ModelMachine::truth() {
  ModelTruth truth{sampled_.imperfections, hidden_->twin.lostSteps(), {}};
  if (options_.beside_real_camera) truth.exposures = hidden_->twin.takeExposures();
  return truth;
}

const twin::Sheet& ModelMachine::sheet() { return hidden_->twin.sheet(); }

std::unique_ptr<camera::FrameSource> ModelMachine::spotFrames(double from_s, double to_s, int threads) {
  std::vector<twin::Exposure> exposures = hidden_->twin.takeExposures();
  std::erase_if(exposures, [&](const twin::Exposure& e) { return e.start_s < from_s || e.start_s > to_s; });
  return std::make_unique<camera::TwinFrameSource>(spotCamera(), std::move(exposures), threads);
}

std::unique_ptr<camera::FramesMeanwhile> ModelMachine::spotFramesMeanwhile(int threads) {
  if (feed_) throw std::logic_error("ModelMachine: somebody looks at the spot already");
  feed_ = std::make_shared<camera::ExposureFeed>(kMostWaiting);
  return std::make_unique<camera::TwinFrameSource>(spotCamera(), feed_, threads);
}

twin::SpotCamera ModelMachine::spotCamera() const {
  const twin::MachineDescription& machine = test_case_.machine;
  return {machine.spot_camera, asPrinted().scenario.print, machine.glow_gray_per_w, test_case_.scenario.seed};
}

std::unique_ptr<camera::TileSource> ModelMachine::kerfTiles(int threads) {
  camera::TwinTileOptions options;
  options.threads = threads;
  return std::make_unique<camera::TwinTileSource>(
      run::kerfTiles(asPrinted(), sampled_.machine, sheet(), options));
}

scenario::Case ModelMachine::asPrinted() const {
  scenario::Case printed = test_case_;
  printed.scenario.print = scenario::webOn(sampled_.machine, test_case_).print;
  return printed;
}

}  // namespace kerfbench::run
