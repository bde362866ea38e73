// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"

namespace kerfbench::campaign {

/// What a factor is in one run.
struct FactorValue {
  std::string factor;
  std::string value;           ///< The value as text; of a fault its name.
  std::optional<double> size;  ///< Size of a fault that has one.
  std::size_t kind{};          ///< Index in Factor::kinds.

  friend bool operator==(const FactorValue&, const FactorValue&) = default;
};

/// What one run of a campaign is made of.
struct RunPlan {
  std::size_t index{};
  std::size_t base{};                 ///< Index in Campaign::bases.
  std::vector<FactorValue> factors;   ///< In the order of Campaign::factors.
  std::optional<std::uint64_t> seed;  ///< The scenario's; absent where the campaign sets the key itself.

  friend bool operator==(const RunPlan&, const RunPlan&) = default;
};

/// Number of points of the grid: of all bases and all levels of all factors; what is drawn has one level.
/// More than kMostRuns are kMostRuns + 1.
std::size_t pointsOf(const Campaign& campaign);

/// The plan of one run, index < campaign.runs(). It depends on the campaign file and the index alone: the
/// same in any shard and any order.
///
/// In a grid the last factor runs the fastest, and the repeats of a point follow each other. What is drawn is
/// a pure function of seed, name of the factor and index (CounterRandom), rounded to six digits: a factor
/// that is added or moved changes no other one's values.
RunPlan planOf(const Campaign& campaign, std::size_t index);

/// Runs of shard `shard` of `shards`, 1 … shards, of so many: every shards-th.
std::vector<std::size_t> indicesOf(std::size_t runs, std::size_t shard, std::size_t shards);

}  // namespace kerfbench::campaign
