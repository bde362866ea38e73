// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/artefact.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "hil/dieline/geometry.h"
#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

constexpr std::uint64_t kFaultStream = 0x6661756c74ULL;

Artefact makeArtefact(CornerAngle corner) {
  Artefact artefact;
  const auto add = [&](dieline::Curve curve, dieline::Process process = dieline::Process::kCut) {
    const int id = static_cast<int>(artefact.dieline.entities.size());
    artefact.dieline.entities.push_back({id, std::move(curve), process, "", ""});
    return id;
  };
  artefact.dieline.path = "gauge artefact";
  add(dieline::LineCurve{{-9.0, -7.0}, {-1.0, -7.0}});
  add(dieline::LineCurve{{2.0, -8.0}, {2.0, -1.0}});
  add(dieline::LineCurve{{5.0, -8.0}, {10.5, -3.5}});
  add(dieline::LineCurve{{-10.5, -4.5}, {-3.0, -1.0}});
  add(dieline::ArcCurve{{-7.5, 3.5}, 3.0, 0.3, 4.4});
  artefact.circle = add(dieline::ArcCurve{{0.5, 4.5}, 2.2, 0.0, 2.0 * std::numbers::pi});
  add(dieline::LineCurve{{5.0, -1.0}, {10.5, 1.5}}, dieline::Process::kCrease);
  artefact.corner_in = add(dieline::LineCurve{{5.0, 7.5}, {10.5, 7.5}});
  constexpr std::array kTurn_deg{30.0, 60.0, 90.0, 120.0, 150.0};
  const double turn_rad = std::numbers::pi / 180.0 * kTurn_deg.at(static_cast<std::size_t>(corner));
  const Eigen::Vector2d at(10.5, 7.5);
  artefact.corner_out =
      add(dieline::LineCurve{at, at + 3.5 * Eigen::Vector2d(std::cos(turn_rad), -std::sin(turn_rad))});
  artefact.print.units = 1;
  artefact.print.pitch_mm = 80.0;
  // No turn of the sheet maps the marks onto each other.
  artefact.print.marks = {
      {{-13.5, -10.0}, 3.0}, {{13.5, -10.4}, 3.0}, {{-13.2, 10.0}, 3.0}, {{13.5, 10.0}, 3.0}};
  return artefact;
}

}  // namespace

std::string_view faultName(FaultKind kind) {
  switch (kind) {
    case FaultKind::kOffset:
      return "offset";
    case FaultKind::kBump:
      return "bump";
    case FaultKind::kCorner:
      return "corner";
    case FaultKind::kEnd:
      return "end";
    case FaultKind::kScale:
      return "scale";
    case FaultKind::kRotation:
      return "rotation";
    case FaultKind::kWave:
      return "wave";
    case FaultKind::kEntity:
      break;
  }
  return "entity";
}

const Artefact& gaugeArtefact(CornerAngle corner) {
  static const std::array<Artefact, kCornerAngles.size()> artefacts = [] {
    std::array<Artefact, kCornerAngles.size()> all;
    for (std::size_t i = 0; i < all.size(); ++i) all.at(i) = makeArtefact(kCornerAngles.at(i));
    return all;
  }();
  return artefacts.at(static_cast<std::size_t>(corner));
}

Fault drawFault(FaultKind kind, double size_mm, const Artefact& artefact, std::uint64_t seed) {
  const CounterRandom random(seed, kFaultStream + static_cast<std::uint64_t>(kind));
  Fault fault{.kind = kind, .size_mm = size_mm};
  fault.direction_rad = 2.0 * std::numbers::pi * random.uniform(0);
  fault.place = 0.15 + 0.7 * random.uniform(2);
  fault.length_mm = kind == FaultKind::kBump ? 0.4 + 1.1 * random.uniform(3) : 2.5 + 5.5 * random.uniform(3);
  fault.phase_rad = 2.0 * std::numbers::pi * random.uniform(4);
  fault.at_start = random.uniform(5) < 0.5;
  std::vector<int> fit;
  for (const dieline::Entity& e : artefact.dieline.entities) {
    const bool meets = e.id == artefact.corner_in || e.id == artefact.corner_out;
    if (e.process != dieline::Process::kCut || meets ||
        (kind == FaultKind::kEnd && dieline::isClosed(e.curve)))
      continue;
    fit.push_back(e.id);
  }
  fault.entity = fit[static_cast<std::size_t>(random.uniform(1) * static_cast<double>(fit.size()))];
  const bool both_ways = kind != FaultKind::kOffset;
  if (both_ways && random.uniform(6) < 0.5) fault.size_mm = -fault.size_mm;
  return fault;
}

}  // namespace kerfbench::gauge
