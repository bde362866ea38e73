// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/case_plan.h"

#include <array>

#include <fmt/format.h>

#include "hil/base/number_from.h"
#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

constexpr std::array kStudyNames{"bad", "good", "coverage", "repeat", "relay", "grr", "still", "stillrepeat"};
constexpr std::uint64_t kCaseSeed = 0x67617567655f6361ULL;

std::string_view presetName(twin::Preset preset) {
  return preset == twin::Preset::kStatic ? "static" : preset == twin::Preset::kDynamic ? "dynamic" : "ideal";
}

CounterRandom randomOf(const CaseId& id, std::size_t index, std::uint64_t seed) {
  const auto stream = static_cast<std::uint64_t>(id.preset) * kStudies + static_cast<std::uint64_t>(id.study);
  return {CounterRandom(seed ^ kCaseSeed, stream).bits(index), 0};
}

Fault anyFault(std::size_t index, double size_mm, std::uint64_t seed) {
  return drawFault(kFaultKinds.at(index % kFaultKinds.size()), size_mm, gaugeArtefact(), seed);
}

}  // namespace

std::string_view studyName(Study study) { return kStudyNames.at(static_cast<std::size_t>(study)); }

std::string nameOf(const CaseId& id) {
  return fmt::format("{}-{}-{}", presetName(id.preset), studyName(id.study), id.index);
}

std::optional<CaseId> caseFromName(std::string_view name) {
  const auto first = name.find('-');
  const auto second = name.find('-', first + 1);
  if (first == std::string_view::npos || second == std::string_view::npos) return std::nullopt;
  CaseId id;
  const std::string_view preset = name.substr(0, first);
  if (preset == "ideal") {
    id.preset = twin::Preset::kIdeal;
  } else if (preset == "static") {
    id.preset = twin::Preset::kStatic;
  } else if (preset == "dynamic") {
    id.preset = twin::Preset::kDynamic;
  } else {
    return std::nullopt;
  }
  const std::string_view study = name.substr(first + 1, second - first - 1);
  std::size_t at = 0;
  while (at < kStudyNames.size() && study != kStudyNames.at(at)) ++at;
  if (at == kStudyNames.size()) return std::nullopt;
  id.study = static_cast<Study>(at);
  const auto index = base::numberFrom<decltype(id.index)>(name.substr(second + 1));
  if (!index) return std::nullopt;
  id.index = *index;
  return id;
}

KerfCase kerfCase(const CaseId& id, std::uint64_t seed, const KerfStudy& study) {
  KerfCase c;
  c.name = nameOf(id);
  c.preset = id.preset;
  const CounterRandom own = randomOf(id, id.index, seed);
  const CounterRandom common = randomOf(id, 0, seed);
  c.machine_seed = own.bits(0);
  c.place_seed = own.bits(1);
  c.board_seed = own.bits(2);
  c.noise_seed = own.bits(3);
  c.world_seed = own.bits(12);
  switch (id.study) {
    case Study::kBad:
    case Study::kGood: {
      const bool bad = id.study == Study::kBad;
      const double target_mm =
          bad ? kBadFrom_mm + (kBadTo_mm - kBadFrom_mm) * own.uniform(4) : kGoodTo_mm * own.uniform(4);
      c.faults = {anyFault(id.index, target_mm, own.bits(5))};
      study.scaleTo(target_mm, c);
      break;
    }
    case Study::kCoverage: {
      c.faults = {anyFault(id.index, 0.1 * own.uniform(4), own.bits(5))};
      // One fault of each kind: an arc that cuts the corner from afar would reach where lines are judged.
      if (c.faults[0].kind != FaultKind::kCorner) {
        c.faults.push_back(
            drawFault(FaultKind::kCorner, 0.015 + 0.085 * own.uniform(6), gaugeArtefact(), own.bits(7)));
      }
      if (c.faults[0].kind != FaultKind::kEnd)
        c.faults.push_back(drawFault(FaultKind::kEnd, 0.08 * own.uniform(8), gaugeArtefact(), own.bits(9)));
      break;
    }
    case Study::kRepeat:
    case Study::kRelay: {
      c.machine_seed = common.bits(0);
      c.board_seed = common.bits(2);
      if (id.study == Study::kRepeat) c.place_seed = common.bits(1);
      c.faults = {drawFault(FaultKind::kBump, 0.03, gaugeArtefact(), common.bits(5))};
      break;
    }
    default: {
      const std::size_t part = id.index / (kGrrPlacements * kGrrRepeats);
      const std::size_t placement = id.index / kGrrRepeats % kGrrPlacements;
      const CounterRandom of_part = randomOf(id, 1000000 + part, seed);
      c.machine_seed = of_part.bits(0);
      c.board_seed = of_part.bits(2);
      c.place_seed = randomOf(id, 2000000 + placement, seed).bits(1);
      const double target_mm = 0.09 * (static_cast<double>(part) + 1.0) / static_cast<double>(kGrrParts);
      // Faults of lines alone: what is measured is their worst deviation.
      constexpr std::array kLines{FaultKind::kOffset,   FaultKind::kBump, FaultKind::kScale,
                                  FaultKind::kRotation, FaultKind::kWave, FaultKind::kEntity};
      c.faults = {drawFault(kLines.at(part % kLines.size()), target_mm, gaugeArtefact(), of_part.bits(5))};
      study.scaleTo(target_mm, c);
      break;
    }
  }
  return c;
}

StillCase stillCase(const CaseId& id, std::uint64_t seed) {
  StillCase c;
  c.name = nameOf(id);
  c.preset = id.preset;
  const CounterRandom own = randomOf(id, id.index, seed);
  const CounterRandom& from = id.study == Study::kStillRepeat ? randomOf(id, 0, seed) : own;
  c.machine_seed = from.bits(0);
  c.place_seed = from.bits(1);
  c.board_seed = from.bits(2);
  c.noise_seed = own.bits(3);
  const auto either = [&](std::uint64_t index, double most) {
    return most * (2.0 * from.uniform(index) - 1.0);
  };
  for (std::uint64_t cut = 0; cut < 3; ++cut)
    c.cuts.push_back({either(10 + cut, 0.1), either(20 + cut, 0.02), either(30 + cut, 0.004)});
  c.speed_mm_s = 30.0 + 90.0 * from.uniform(40);
  return c;
}

}  // namespace kerfbench::gauge
