// SPDX-License-Identifier: Apache-2.0
#include "hil/run/model_machine.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hil/camera/seen_frames.h"
#include "hil/camera/twin/exposure_feed.h"
#include "hil/camera/twin/twin_frames.h"
#include "hil/run/cut_on_twin.h"
#include "hil/run/passing_web.h"
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

// Beyond field and travel, as a share of the field: a beam that a fault drives there is far from any line.
constexpr double kBeyondField = 0.25;

/// Where the web is beyond the beam, x in W.
double endOfReach_mm(const twin::MachineDescription& machine) {
  const twin::ControllerDescription& told = machine.controller;
  const double field_mm = told.field_max_mm[0] - told.field_min_mm[0];
  return std::max(told.field_max_mm[0], machine.travel_max_mm[0]) + kBeyondField * field_mm;
}

MachineState stateOf(const twin::Twin& twin) {
  const twin::Twin::Truth truth = twin.truth();
  return {twin.pose(), truth.p_WQ_mm, truth.emitted_j};
}

camera::FrameSeen shownTo(Onlooker& onlooker) {
  return [&onlooker](const Frame& frame) { onlooker.sawFrame(frame); };
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
  std::optional<PassingWeb> web;  ///< Absent: it is photographed afterwards.
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
  LockstepOptions shown = options;
  if (Onlooker* const onlooker = options_.onlooker) {
    onlooker->begins(stateOf(twin), source.info().rate);
    shown.seen = [onlooker, &twin](const Quantum& quantum) { onlooker->saw(quantum, stateOf(twin)); };
  }
  FilmedSource filmed(source, twin, film_);
  const Onlookers onlookers{feed_.get(), hidden_->web ? &*hidden_->web : nullptr};
  TwinModel alone(twin, onlookers);
  WitnessedTwin witnessed(twin, onlookers);
  LockstepModel& model = options_.witness_sensors ? static_cast<LockstepModel&>(witnessed) : alone;
  RecordedRun result = runLockstep(filmed, model, test_case_.machine.signals, dialog, shown, progress);
  film_.add(twin);
  due_sensors_ = witnessed.due();
  if (hidden_->web) hidden_->web->end(twin);
  if (twin.beamOnPartedWeb())
    result.problems.emplace_back(
        "the beam reached web that had left the machine: it went far beyond its field, or the belt ran back");
  return result;
}

ModelTruth ModelMachine::truth() {
  ModelTruth truth{sampled_.imperfections, hidden_->twin.lostSteps(), {}};
  if (options_.beside_real_camera) truth.exposures = hidden_->twin.takeExposures();
  return truth;
}

const twin::Sheet& ModelMachine::sheet() {
  if (hidden_->web) throw std::logic_error("ModelMachine: the sheet is being taken away while it is cut");
  return hidden_->twin.sheet();
}

std::unique_ptr<camera::FrameSource> ModelMachine::spotFrames(double from_s, double to_s, int threads) {
  std::vector<twin::Exposure> exposures = hidden_->twin.takeExposures();
  std::erase_if(exposures, [&](const twin::Exposure& e) { return e.start_s < from_s || e.start_s > to_s; });
  auto frames = std::make_unique<camera::TwinFrameSource>(spotCamera(), std::move(exposures), threads);
  if (options_.onlooker == nullptr) return frames;
  return std::make_unique<camera::SeenFrames>(std::move(frames), shownTo(*options_.onlooker));
}

std::unique_ptr<camera::FramesMeanwhile> ModelMachine::spotFramesMeanwhile(int threads) {
  if (feed_) throw std::logic_error("ModelMachine: somebody looks at the spot already");
  feed_ = std::make_shared<camera::ExposureFeed>(kMostWaiting);
  auto frames = std::make_unique<camera::TwinFrameSource>(spotCamera(), feed_, threads);
  if (options_.onlooker == nullptr) return frames;
  return std::make_unique<camera::SeenFramesMeanwhile>(std::move(frames), shownTo(*options_.onlooker));
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

std::unique_ptr<camera::TilesMeanwhile> ModelMachine::kerfTilesMeanwhile(int threads,
                                                                         std::size_t most_waiting) {
  if (hidden_->web) throw std::logic_error("ModelMachine: somebody looks at the cut already");
  const auto feed = std::make_shared<camera::SheetFeed>(most_waiting);
  camera::TwinTileOptions options;
  options.threads = threads;
  auto tiles =
      std::make_unique<camera::TwinTileSource>(run::kerfTiles(asPrinted(), sampled_.machine, feed, options));
  std::optional<std::vector<double>> partings_S_mm = tiles->partings_S_mm();
  if (!partings_S_mm) return nullptr;
  hidden_->web.emplace(feed, std::move(*partings_S_mm), endOfReach_mm(sampled_.machine));
  return tiles;
}

scenario::Case ModelMachine::asPrinted() const {
  scenario::Case printed = test_case_;
  printed.scenario.print = scenario::webOn(sampled_.machine, test_case_).print;
  return printed;
}

}  // namespace kerfbench::run
