// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/shares.h"
#include "hil/campaign/detection.h"
#include "hil/campaign/record.h"

namespace kerfbench::campaign {

/// Outcomes of runs by number.
struct Outcomes {
  std::size_t pass{}, fail{}, not_proven{}, invalid{};
  std::size_t refused{}, broken{};  ///< Without a verdict.

  void add(const std::string& outcome);
  [[nodiscard]] std::size_t judged() const { return pass + fail + not_proven + invalid; }
  [[nodiscard]] std::size_t all() const { return judged() + refused + broken; }
};

/// Runs in which a factor has one value, or one within a range where it was drawn.
struct RateRow {
  std::string value;
  Outcomes outcomes;
  std::optional<base::Interval> pass_rate;  ///< 95 %, of the runs that were judged; absent without any.
};

/// Pass rate over the values of one factor; the base scenario and the seed's part in it are none.
struct FactorRates {
  std::string factor;
  std::vector<RateRow> rows;
};

/// How small a fault of one kind is found, in runs of one base scenario.
struct FaultDetection {
  std::string base, factor, fault;
  Detection by_fail;                    ///< Found: the run is FAIL.
  Detection by_no_pass;                 ///< Found: the run is not PASS, whatever else it is.
  std::vector<Trial> fails, no_passes;  ///< Trials of both.
};

/// How near runs came to the limit of a check: those without a fault of a size, whatever their verdict; where
/// there are none of them, those that passed.
///
///     margin = (limit - (value + U)) / |limit|, for a lower limit ((value - U) - limit) / |limit|
struct CheckMargin {
  std::string check, unit;
  std::size_t runs{};  ///< Number of those in which it was measured and has a limit other than zero.
  double least{}, median{};
  CheckRecord thinnest;  ///< Where the margin is least.
  std::size_t thinnest_run{};
  std::vector<double> margins;  ///< Margins of all runs, by index.
  std::vector<std::size_t> at;  ///< Runs of these margins.
};

/// How often a check did not pass.
struct CheckCount {
  std::string check;
  std::size_t fail{}, not_proven{}, invalid{};
};

/// What a campaign tells.
struct Analysis {
  std::string name, title, identity, digest;
  std::size_t runs{};
  std::vector<std::size_t> missing;
  Outcomes outcomes;
  std::vector<FactorRates> rates;
  std::vector<FaultDetection> detections;
  std::vector<CheckMargin> margins;  ///< The thinnest first.
  bool margins_of_good{};            ///< Margins are of runs without a fault of a size.
  std::vector<CheckCount> counts;    ///< Checks that found the most come first.
};

/// The records must be of one campaign.
Analysis analyse(const std::vector<Record>& records);

/// Share of the limit that a check has left; nothing where it has none, or was not measured.
std::optional<double> marginOf(const CheckRecord& check);

std::string analysisJson(const Analysis& analysis);
/// A page that loads nothing from elsewhere.
std::string analysisPage(const Analysis& analysis, const std::vector<Record>& records);
/// The same in some lines for a terminal.
std::vector<std::string> analysisLines(const Analysis& analysis);

/// Writes analysis.json and campaign.html. @throws std::system_error.
void writeAnalysis(const Analysis& analysis, const std::vector<Record>& records,
                   const std::filesystem::path& folder);

}  // namespace kerfbench::campaign
