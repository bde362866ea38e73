// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/kerf_case.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/gauge/statistics.h"
#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kFieldStream = 0x6669656c64ULL;
constexpr std::uint64_t kTubeNoise = 0x74756265ULL;
constexpr std::size_t kFieldStride = 8;

/// Where in the machine's field the artefact is cut.
Vector2d placeInMachine(const twin::MachineDescription& machine, std::uint64_t seed) {
  const CounterRandom random(seed, kFieldStream);
  const auto within = [&](std::uint64_t index, std::size_t axis) {
    const double low = machine.controller.field_min_mm.at(axis);
    const double high = machine.controller.field_max_mm.at(axis);
    return 0.5 * (low + high) + 0.7 * (high - low) * (random.uniform(index) - 0.5);
  };
  return {within(0, 0), within(1, 1)};
}

void addField(const KerfMeasurement& m, const CutTruth& truth, const Placement& placement,
              const dieline::Dieline& dieline, std::vector<FieldError>& field) {
  for (std::size_t k = 0; k < m.scan.entities.size(); ++k) {
    const vision::EntityKerf& kerf = m.scan.entities[k];
    const dieline::Curve& curve = dieline.entities[static_cast<std::size_t>(kerf.entity)].curve;
    const double length_mm = dieline::lengthOf(curve);
    for (std::size_t i = 0; i < kerf.calipers.size(); i += kFieldStride) {
      const vision::Caliper& c = kerf.calipers[i];
      const bool at_end = !dieline::isClosed(curve) && std::min(c.station_mm, length_mm - c.station_mm) < 0.3;
      if (!c.found || c.near_joint || at_end) continue;
      const Vector2d t = dieline::tangentAt(curve, c.u);
      const Vector2d normal = placement.X_TS.linear() * Vector2d(-t.y(), t.x());
      field.push_back({c.p_V_mm, normal, c.offset_mm - truth.entities[k].offset_mm[i]});
    }
  }
}

void addLines(const KerfMeasurement& m, const CutTruth& truth, const dieline::Dieline& dieline,
              std::uint64_t pick, std::vector<Reading>& readings) {
  for (const inspect::UncertaintyBudget& b : m.result.budgets)
    readings.push_back({"worst of all lines", b.monte_carlo_value, b.monte_carlo_U, truth.worst_mm});
  readings.push_back({"RMS of all lines", m.result.rms_mm.value, m.result.rms_mm.U, truth.rms_mm});
  // One entity of each case, so that cases are independent.
  const std::size_t one = pick % m.result.entities.size();
  const inspect::EntityResult& e = m.result.entities[one];
  const EntityTruth& t = truth.entities[one];
  readings.push_back({"worst of an entity", std::abs(e.worst_mm), e.worst_U_mm, t.worst_mm});
  readings.push_back({"RMS of an entity", e.rms_mm, e.rms_U_mm, t.rms_mm});
  readings.push_back({"kerf width", e.width_mm, e.width_U_mm, t.width_mm});
  // As the judge takes it: against the widths of the other cuts.
  std::vector<double> widths;
  std::vector<double> true_widths;
  for (std::size_t k = 0; k < truth.entities.size(); ++k) {
    if (dieline.entities[k].process != dieline::Process::kCut) continue;
    widths.push_back(m.result.entities[k].width_mm);
    true_widths.push_back(truth.entities[k].width_mm);
  }
  if (dieline.entities[one].process == dieline::Process::kCut) {
    readings.push_back({"kerf width against the others", e.width_mm - quantileOf(widths, 0.5),
                        e.width_own_U_mm, t.width_mm - quantileOf(true_widths, 0.5)});
  }
  for (std::size_t k = 0; k < truth.entities.size(); ++k) {
    if (std::isfinite(truth.entities[k].circularity_mm)) {
      readings.push_back({"circularity", m.result.entities[k].circularity_mm,
                          m.result.entities[k].circularity_U_mm, truth.entities[k].circularity_mm});
    }
  }
}

void addJoints(const KerfMeasurement& m, const CutTruth& truth, std::uint64_t pick,
               std::vector<Reading>& readings) {
  // What is not there at all is not rounded or run over: its zero would count as found each time.
  constexpr double kThere_mm = 0.01;
  constexpr double kInPlace_mm = 0.005;
  const std::string where = truth.corner_shift_mm > kInPlace_mm ? ", cut displaced" : "";
  std::vector<Reading> ends;
  for (const inspect::JointResult& j : m.result.joints) {
    if (j.kind == inspect::JointResult::Kind::kCorner && truth.corner_mm > kThere_mm)
      readings.push_back({"corner off the dieline" + where, j.mm.value, j.mm.U, truth.corner_mm});
    if (j.kind == inspect::JointResult::Kind::kRounding && truth.rounding_mm > kThere_mm)
      readings.push_back({"corner rounding" + where, j.mm.value, j.mm.U, truth.rounding_mm});
    if (j.kind == inspect::JointResult::Kind::kOvershoot && truth.overshoot_mm > kThere_mm)
      readings.push_back({"corner overshoot" + where, j.mm.value, j.mm.U, truth.overshoot_mm});
    if (j.kind != inspect::JointResult::Kind::kEndGap) continue;
    for (const CutTruth::End& end : truth.ends) {
      if (end.entity == j.entity && end.at_start == j.at_start)
        ends.push_back({"end gap or overlap", j.mm.value, j.mm.U, end.gap_mm});
    }
  }
  if (!ends.empty()) readings.push_back(ends[pick / 16 % ends.size()]);
}

}  // namespace

KerfStudy::KerfStudy(const GaugeSetup& setup) : setup_(setup) {
  for (const CornerAngle corner : kCornerAngles) instruments_.emplace_back(setup, gaugeArtefact(corner));
}

World KerfStudy::worldOf(const KerfCase& test_case) const {
  const twin::CameraDescription& camera = setup_.machine.kerf_camera;
  World world = setup_.mismatch ? otherWorld(setup_.board, camera, test_case.world_seed)
                                : toldWorld(setup_.board, camera);
  lean(setup_.kerf_calibration, test_case.place_seed, world);
  const twin::MachineDescription sampled =
      twin::drawImperfections(setup_.machine, setup_.spread, test_case.preset, test_case.machine_seed)
          .machine;
  world.open_gray = sampled.kerf_camera.open_gray;
  world.scale = (1.0 + sampled.board_lot.swelling) * sampled.kerf_camera.fx_px / camera.fx_px;
  return world;
}

ArtefactCut KerfStudy::cutOf(const KerfCase& test_case, const World& world) const {
  const twin::SampledMachine sampled =
      twin::drawImperfections(setup_.machine, setup_.spread, test_case.preset, test_case.machine_seed);
  ArtefactBeam beam(sampled.machine, placeInMachine(setup_.machine, test_case.machine_seed));
  beam.power = sampled.machine.laser.full_power_w / setup_.machine.laser.full_power_w;
  beam.radius_x_mm *= world.radius;
  beam.radius_y_mm *= world.radius;
  beam.crease_energy = world.radius;
  return {gaugeArtefact(world.corner), test_case.faults, beam, test_case.machine_seed ^ kTubeNoise};
}

void KerfStudy::scaleTo(double truth_mm, KerfCase& test_case) const {
  // Monotonous but for what the others do: regula falsi from the size itself.
  const World world = worldOf(test_case);
  const double sign = test_case.faults.at(0).size_mm < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < 8; ++i) {
    const double size = std::abs(test_case.faults[0].size_mm);
    const double is = cutOf(test_case, world).worst_mm(0.1);
    if (std::abs(is - truth_mm) < 1e-4) return;
    test_case.faults[0].size_mm = sign * std::max(1e-6, size * truth_mm / std::max(is, 1e-6));
  }
}

KerfStudy::Whole KerfStudy::runWhole(const KerfCase& test_case) const {
  const World world = worldOf(test_case);
  const Artefact& artefact = gaugeArtefact(world.corner);
  const KerfInstrument& instrument = instruments_.at(static_cast<std::size_t>(world.corner));
  const ArtefactCut cut = cutOf(test_case, world);
  twin::Sheet sheet(world.board);
  const double radius_mm = setup_.machine.beam.waist_radius_mm;
  cut.burn(sheet, radius_mm);
  const Placement placement = instrument.draw(test_case.place_seed);
  camera::KerfTile tile =
      instrument.picture(sheet, world, placement, test_case.board_seed, test_case.noise_seed);
  Whole whole;
  whole.world = world;
  whole.picture = tile.image;
  whole.measurement = instrument.measure(std::move(tile), placement, world.told_thickness_mm);
  const KerfMeasurement& m = whole.measurement;
  whole.truth = cut.truth(m.scan.entities, world.board, radius_mm);
  KerfOutcome& out = whole.outcome;
  out.name = test_case.name;
  if (!test_case.faults.empty()) {
    out.kind = test_case.faults[0].kind;
    out.size_mm = test_case.faults[0].size_mm;
  }
  out.truth_mm = std::max(whole.truth.worst_mm, whole.truth.worstJoint_mm());
  out.verdict = m.verdict;
  for (const inspect::Check& check : m.result.checks) {
    if (check.name == "path") out.path_verdict = check.verdict;
  }
  out.problems = m.result.problems;
  if (m.result.entities.size() != whole.truth.entities.size()) return whole;
  const std::uint64_t pick = CounterRandom(test_case.machine_seed, 1).bits(0) % 100000;
  addLines(m, whole.truth, artefact.dieline, pick, out.readings);
  addJoints(m, whole.truth, pick, out.readings);
  for (const inspect::UncertaintyBudget& b : m.result.budgets) {
    out.worst_as_read_mm = b.as_read;
    out.analytic_U_mm = b.analytic_U;
    out.monte_carlo_U_mm = b.monte_carlo_U;
  }
  addField(m, whole.truth, placement, artefact.dieline, out.field);
  return whole;
}

KerfOutcome KerfStudy::run(const KerfCase& test_case) const { return std::move(runWhole(test_case).outcome); }

}  // namespace kerfbench::gauge
