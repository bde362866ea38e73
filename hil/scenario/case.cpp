// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/case.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/order/hand_order.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/geometry.h"
#include "hil/machine_file/machine_check.h"
#include "twin/cutter/machine_faults.h"

namespace kerfbench::scenario {
namespace {

// Without this, a drawing with two lines on top of each other would be burnt twice. What is accepted is
// noted.
void refuseUnfit(dieline::Dieline& dieline, const std::set<dieline::LintFinding::Kind>& accepted,
                 const base::ProgressFn& progress) {
  std::string message;
  constexpr std::size_t kMost = 20;
  const dieline::LintReport report = dieline::lintDieline(dieline, kMost, progress);
  for (const dieline::LintFinding& finding : report.findings) {
    if (!finding.is_error || dieline::isAccepted(finding, accepted)) continue;
    message += fmt::format("{}{}: at ({:.3f}, {:.3f}) mm, layer {}: {}", message.empty() ? "" : "\n",
                           dieline.path, finding.p_mm.x(), finding.p_mm.y(), finding.layer, finding.message);
  }
  if (!message.empty()) {
    for (const std::string& sentence : dieline::uncounted(report))
      message += fmt::format("\n{}: {}", dieline.path, sentence);
    if (const auto advice = dieline::adviceOnRepeats(report))
      message += fmt::format("\n{}: {}", dieline.path, *advice);
    throw base::ConfigError(message);
  }
  for (std::string& sentence : dieline::acceptedSentences(report, accepted))
    dieline.notes.push_back(std::move(sentence));
}

/// With a selection, what is not selected still tells outlines from holes, so all of the drawing must be fit.
void refuseUnfitNesting(const Scenario& scenario, dieline::Dieline whole, const base::ProgressFn& progress) {
  if (!needsWholeDrawing(scenario)) return;
  for (dieline::Entity& entity : whole.entities) entity.process = dieline::drawnFor(entity);
  try {
    refuseUnfit(whole, scenario.accepted, progress);
  } catch (const base::ConfigError& error) {
    throw base::ConfigError(
        fmt::format("{}: select: the whole drawing tells outlines from holes, and is unfit:\n{}",
                    scenario.path.string(), error.what()));
  }
}

void refuseUnsoundOrder(const Scenario& scenario, const dieline::Dieline& dieline) {
  // G-code of the user's own has an order already.
  if (scenario.job.order != planner::JobParameters::Order::kGiven || !scenario.job_gcode.empty()) return;
  const std::vector<std::string> faults = planner::orderFaults(dieline, scenario.job.given_order);
  if (faults.empty()) return;
  throw base::ConfigError(
      fmt::format("{}: planner.order: {}", scenario.path.string(), fmt::join(faults, "; ")));
}

/// The drawing as the scenario wants it cut.
dieline::Dieline selectedDieline(const Scenario& scenario, const base::ProgressFn& progress) {
  dieline::DrawingOptions drawing = scenario.drawing;
  drawing.progress = progress;
  dieline::Dieline dieline = dieline::readDieline(scenario.dieline, drawing);
  try {
    planner::select(dieline, scenario.selection);
  } catch (const planner::PlanError& error) {
    throw base::ConfigError(fmt::format("{}: select: {}", scenario.path.string(), error.what()));
  }
  refuseUnfit(dieline, scenario.accepted, progress);
  refuseUnfitNesting(scenario, dieline, progress);
  refuseUnsoundOrder(scenario, dieline);
  return dieline;
}

/// The catalogue's entry of an axis's drive.
planner::DriveNeeds needsOf(const twin::AxisDescription& axis) {
  const DriverProfile& profile = axis.profile;
  return {.name = profile.name,
          .falling_edge = !profile.active_edge_rising,
          .dir_low = profile.dir_low,
          .setup_s = profile.setup_s,
          .hold_s = profile.hold_s,
          .width_s = profile.width_s,
          .space_s = profile.space_s};
}

/// What the scenario asks of its machine, and that has not.
void refuseLacking(const Case& test_case) {
  const Scenario& scenario = test_case.scenario;
  const auto refuse = [&](std::string_view key, const std::string& what) {
    throw base::ConfigError(fmt::format("{}: {}: {}", scenario.path.string(), key, what));
  };
  const std::string machine = scenario.machine.string();
  const SignalMap& signals = test_case.machine.signals;
  if (scenario.belt_by_controller && !(test_case.machine.belt.feed.step > 0))
    refuse("belt.drive", fmt::format("the controller cannot feed, {} has no belt.feed", machine));
  if (scenario.firmware.start_s && !signals.pin(Signal::kStart))
    refuse("firmware.start_s", fmt::format("{} has no pin `start`", machine));
  for (const Signal signal : signalsOf(scenario.provoke)) {
    if (!signals.pin(signal)) refuse("provoke", fmt::format("{} has no pin {}", machine, signalName(signal)));
  }
  if (scenario.provoke.cause == ProvokeChoice::Cause::kFieldLeft &&
      test_case.machine.kind != twin::MachineDescription::Kind::kGantry)
    refuse("provoke.field_left", fmt::format("{} has no gantry, whose pins tell where it is", machine));
}

}  // namespace

bool needsWholeDrawing(const Scenario& scenario) {
  const bool counts =
      scenario.limits.edge != inspect::Tolerances::Edge::kCentre || scenario.job.kerf_radius_mm > 0.0;
  return counts && !scenario.selection.all();
}

void refuseUnwired(const Case& test_case) {
  refuseLacking(test_case);
  const FirmwareChoice& firmware = test_case.scenario.firmware;
  if (!firmware.onRealPins()) return;
  const WiringNeeds needs{.gantry = test_case.machine.kind == twin::MachineDescription::Kind::kGantry,
                          .moving_sheet = test_case.scenario.sheetMoves()};
  const std::string faults = firmware.source == FirmwareChoice::Source::kGpio
                                 ? faultsOf(firmware.gpio, test_case.machine.signals, needs)
                                 : faultsOf(firmware.analyser, test_case.machine);
  if (!faults.empty()) throw base::ConfigError(faults);
}

Case readCase(const std::filesystem::path& scenario, const ImagePath& images,
              const base::ProgressFn& progress) {
  return caseOf(readScenario(scenario, images), progress);
}

Case caseOf(Scenario scenario, const base::ProgressFn& progress) {
  Case test_case;
  test_case.scenario = std::move(scenario);
  const machine_file::MachineFile file = machine_file::readMachineFile(test_case.scenario.machine);
  test_case.machine = file.machine;
  test_case.spread = file.spread;
  test_case.spot_camera = file.spot_camera;
  test_case.kerf_camera = file.kerf_camera;
  test_case.beam_radius_sigma = file.beam_radius_sigma;
  test_case.inputs = test_case.scenario.inputs;
  for (const std::filesystem::path& input : file.inputs)
    if (std::ranges::find(test_case.inputs, input) == test_case.inputs.end())
      test_case.inputs.push_back(input);
  refuseUnwired(test_case);
  refuseUnfit(file, webOf(test_case));
  test_case.dieline = std::make_shared<const dieline::Dieline>(selectedDieline(test_case.scenario, progress));
  return test_case;
}

twin::SampledMachine sampledMachine(const Case& test_case) {
  const Scenario& scenario = test_case.scenario;
  twin::SampledMachine sampled =
      twin::drawImperfections(test_case.machine, test_case.spread, scenario.imperfections, scenario.seed);
  // The description was fit: a draw that is not comes from a spread too wide.
  const auto faults = twin::faultsOf(sampled.machine, webOn(sampled.machine, test_case));
  if (!faults.empty()) {
    throw base::ConfigError(fmt::format("{}: imperfections: the machine that seed {} draws cannot run: {}",
                                        scenario.machine.string(), scenario.seed, fmt::join(faults, "; ")));
  }
  return sampled;
}

planner::MachineParameters plannerMachine(const Case& test_case) {
  const auto& told = test_case.machine.controller;
  planner::MachineParameters machine;
  machine.head = test_case.machine.kind == twin::MachineDescription::Kind::kGantry
                     ? planner::MachineParameters::Head::kGantry
                     : planner::MachineParameters::Head::kTwoMirror;
  machine.throw_mm = told.throw_mm;
  machine.mirror_spacing_mm = told.mirror_spacing_mm;
  machine.mirror_step_rad = told.mirror_step_rad;
  machine.focal_length_mm = told.focal_length_mm;
  if (told.focal_length_mm > 0.0) machine.head = planner::MachineParameters::Head::kFTheta;
  if (!told.correction_file.empty()) {
    machine.correction =
        std::make_shared<planner::CorrectionTable>(planner::CorrectionTable::read(told.correction_file));
  }
  machine.mirror_acceleration_rad_s2 = told.mirror_acceleration_rad_s2;
  machine.steppers = {told.full_step_pulses, told.detent_share, told.rotor_resonance_hz, told.rotor_damping};
  machine.gantry_step_mm = told.gantry_step_mm;
  for (const std::size_t i : {0U, 1U}) {
    machine.field_min_mm[i] = told.field_min_mm[i];
    machine.field_max_mm[i] = told.field_max_mm[i];
  }
  machine.tracking_delay_s = told.tracking_delay_s;
  machine.encoder_count_mm = told.encoder_count_mm;
  machine.print_mark_sensor_x_mm = told.print_mark_sensor_x_mm;
  machine.feed_step_mm = told.feed_step_mm;
  machine.full_power_w = told.full_power_w;
  machine.power_quantum_j = told.power_quantum_j;
  machine.laser_lag_s = told.laser_lag_s;
  machine.power_delay_s = told.power_delay_s;
  const twin::MachineDescription& m = test_case.machine;
  if (m.kind == twin::MachineDescription::Kind::kGantry) {
    machine.drives[KB_GANTRY_X] = needsOf(m.gantry_x);
    machine.drives[KB_GANTRY_Y] = needsOf(m.gantry_y);
  } else {
    machine.drives[KB_GALVO_X] = needsOf(m.galvo_x);
    machine.drives[KB_GALVO_Y] = needsOf(m.galvo_y);
  }
  if (m.belt.feed.step > 0.0) machine.drives[KB_FEED] = needsOf(m.belt.feed);
  return machine;
}

planner::MachineParameters targetedMachine(const Case& test_case) {
  planner::MachineParameters machine = plannerMachine(test_case);
  const std::filesystem::path& image = test_case.scenario.firmware.image;
  if (!image.empty()) machine.target = planner::findTarget(image).value_or(planner::Target{});
  return machine;
}

namespace {

double webStartX_mm(const Case& test_case) {
  const Scenario& scenario = test_case.scenario;
  if (scenario.web_start_x_mm) return *scenario.web_start_x_mm;
  // Upstream of the sensor by what the belt runs during the lead time, in which the controller boots and is
  // loaded.
  return test_case.machine.controller.print_mark_sensor_x_mm - scenario.print.eye_mark_x_mm -
         scenario.belt_speed_mm_s * scenario.belt_lead_s;
}

}  // namespace

planner::JobParameters plannerJob(const Case& test_case) {
  planner::JobParameters job = test_case.scenario.job;
  job.web_start_x_mm = webStartX_mm(test_case);
  job.belt_min_mm_s = test_case.scenario.belt_min_mm_s;
  job.belt_max_mm_s = test_case.scenario.belt_max_mm_s;
  job.jump_radius_mm =
      test_case.scenario.jump_radius_mm.value_or(test_case.machine.controller.jump_radius_mm);
  return job;
}

twin::WebDescription webOf(const Case& test_case) {
  const Scenario& scenario = test_case.scenario;
  twin::WebDescription web;
  web.print = scenario.print;
  web.board = scenario.board;
  web.start_x_mm = webStartX_mm(test_case);
  web.belt_speed_mm_s = scenario.belt_speed_mm_s;
  web.belt_speed_changes = scenario.belt_speed_changes;
  web.fed_by_controller = scenario.belt_by_controller;
  return web;
}

twin::WebDescription webOn(const twin::MachineDescription& machine, const Case& test_case) {
  twin::WebDescription web = webOf(test_case);
  const twin::BoardLot& lot = machine.board_lot;
  web.board.thickness_mm *= lot.thickness;
  web.board.cut_fluence_j_mm2 *= lot.cut_fluence;
  web.board.transmission *= lot.transmission;
  web.board.print_transmission *= lot.transmission;
  web.print = twin::printedOn(lot, web.print);
  return web;
}

}  // namespace kerfbench::scenario
