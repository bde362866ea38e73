// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "hil/base/number_from.h"
#include "twin/base/random.h"

namespace kerfbench::campaign {
namespace {

/// Most tries for a normal value within its bounds; the reader sees to it that one in a hundred is.
constexpr std::uint64_t kMostTries = 1U << 16U;
/// Seeds of runs have nine digits at most, so that people can type them.
constexpr std::uint64_t kSeeds = 1'000'000'000;

/// FNV-1a of 64 bits: the same everywhere.
std::uint64_t streamOf(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

CounterRandom randomOf(const Campaign& campaign, std::string_view what, std::string_view name) {
  return {campaign.seed, streamOf(fmt::format("{}:{}", what, name))};
}

std::size_t chosen(const Campaign& campaign, std::string_view what, std::string_view name, std::size_t index,
                   std::size_t count) {
  const double u = randomOf(campaign, what, name).uniform(index);
  return std::min(count - 1, static_cast<std::size_t>(u * static_cast<double>(count)));
}

double drawnNumber(const Values& values, const CounterRandom& random, std::uint64_t index) {
  switch (values.kind) {
    case Values::Kind::kUniform:
      return values.min + (values.max - values.min) * random.uniform(index);
    case Values::Kind::kLogUniform:
      return values.min * std::pow(values.max / values.min, random.uniform(index));
    default:
      break;
  }
  for (std::uint64_t i = 0; i < kMostTries; ++i) {
    const double value = values.mean + values.sigma * random.normal(index * kMostTries + i);
    if (value >= values.min && value <= values.max) return value;
  }
  return std::clamp(values.mean, values.min, values.max);
}

/// The value of these in a run: at a level of the grid, or drawn.
std::string valueOf(const Campaign& campaign, const Values& values, std::string_view name, std::size_t index,
                    std::optional<std::size_t> level) {
  if (!values.isDrawn())
    return values.list[level ? *level : chosen(campaign, "value", name, index, values.list.size())];
  const double value = drawnNumber(values, randomOf(campaign, "value", name), index);
  // Rounding must not lead out of the bounds.
  const std::string text = fmt::format("{:.6g}", value);
  const double rounded = base::numberFrom<double>(text).value_or(value);
  return rounded >= values.min && rounded <= values.max ? text : fmt::format("{:.17g}", value);
}

std::size_t levelsOf(const Kind& kind) {
  return kind.values && !kind.values->isDrawn() ? kind.values->list.size() : 1;
}

std::size_t levelsOf(const Factor& factor) {
  std::size_t levels = 0;
  for (const Kind& kind : factor.kinds) levels += levelsOf(kind);
  return std::max<std::size_t>(levels, 1);
}

/// A factor's value in a run; `level`: of the grid.
FactorValue factorValue(const Campaign& campaign, const Factor& factor, std::size_t index,
                        std::optional<std::size_t> level) {
  FactorValue result{.factor = factor.name, .value = {}, .size = std::nullopt};
  if (level) {
    while (*level >= levelsOf(factor.kinds[result.kind])) *level -= levelsOf(factor.kinds[result.kind++]);
  } else if (factor.is_fault) {
    result.kind = chosen(campaign, "fault", factor.name, index, factor.kinds.size());
  }
  const Kind& kind = factor.kinds[result.kind];
  const std::string stream = factor.is_fault ? factor.name + "/" + kind.name : factor.name;
  const std::string value =
      kind.values ? valueOf(campaign, *kind.values, stream, index, level) : std::string();
  result.value = factor.is_fault ? kind.name : value;
  if (factor.is_fault && kind.values) result.size = base::numberFrom<double>(value);
  return result;
}

}  // namespace

std::size_t pointsOf(const Campaign& campaign) {
  std::size_t points = std::max<std::size_t>(campaign.bases.size(), 1);
  for (const Factor& factor : campaign.factors) points = std::min(points * levelsOf(factor), kMostRuns + 1);
  return points;
}

RunPlan planOf(const Campaign& campaign, std::size_t index) {
  RunPlan plan{.index = index, .base = 0, .factors = {}, .seed = std::nullopt};
  if (campaign.own_seeds) plan.seed = randomOf(campaign, "seed", "").bits(index) % kSeeds;
  plan.factors.resize(campaign.factors.size());
  if (campaign.draws > 0) {
    plan.base = chosen(campaign, "base", "", index, campaign.bases.size());
    for (std::size_t i = 0; i < plan.factors.size(); ++i)
      plan.factors[i] = factorValue(campaign, campaign.factors[i], index, std::nullopt);
    return plan;
  }
  std::size_t point = index / campaign.repeats;
  for (std::size_t i = plan.factors.size(); i-- > 0;) {
    const std::size_t levels = levelsOf(campaign.factors[i]);
    plan.factors[i] = factorValue(campaign, campaign.factors[i], index, point % levels);
    point /= levels;
  }
  plan.base = point;
  return plan;
}

std::vector<std::size_t> indicesOf(std::size_t runs, std::size_t shard, std::size_t shards) {
  std::vector<std::size_t> indices;
  for (std::size_t i = shard - 1; i < runs; i += shards) indices.push_back(i);
  return indices;
}

}  // namespace kerfbench::campaign
