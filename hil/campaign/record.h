// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/grid.h"
#include "hil/compare/run_figures.h"

namespace kerfbench::campaign {

/// What a check of a run came to.
struct CheckRecord {
  std::string name, verdict, unit;
  std::optional<double> value;  ///< Absent where it was not measured.
  double u{};                   ///< Expanded uncertainty (k = 2), in the same unit; 0: none is stated.
  std::optional<double> limit;
  bool lower{};  ///< The limit is a lower one.

  friend bool operator==(const CheckRecord&, const CheckRecord&) = default;
};

/// How a run ended: a verdict, or what kept it from one.
inline constexpr const char* kRefused = "REFUSED";  ///< The bench refused scenario, machine or job.
inline constexpr const char* kBroken = "BROKEN";    ///< The bench broke, twice in the same way.

/// The result of one run. What depends on when, where and how fast it was run is not in it.
struct Record {
  std::size_t run{};  ///< Index in the campaign.
  std::string base;   ///< Name of the base scenario's file, without its ending.
  std::vector<FactorValue> factors;
  std::optional<std::uint64_t> seed;
  std::string outcome;              ///< "PASS", "FAIL", "NOT PROVEN", "INVALID", kRefused or kBroken.
  std::string reason;               ///< Why there is no verdict.
  std::vector<CheckRecord> checks;  ///< Ordered by name.
  std::string digest;               ///< Digest of the verdict; empty without one.

  friend bool operator==(const Record&, const Record&) = default;
};

/// A record with what the plan says, without a result.
Record recordOf(const Campaign& campaign, const RunPlan& plan);
/// Adds a verdict to it.
void addVerdict(Record& record, const compare::RunFigures& figures);

/// The record as one line of JSON, without the line's end.
std::string lineOf(const Record& record);
/// @throws base::InputError that says what is wrong with the line.
Record recordFrom(const std::string& line);

/// Records of a campaign, a file for each run: its line, and a line with the campaign's identity and the sum
/// of both. Files appear whole or not at all; whoever writes one writes the same bytes.
class RecordFolder {
 public:
  /// `campaign`: its identity, as identityOf().
  RecordFolder(std::filesystem::path folder, std::string campaign);

  [[nodiscard]] std::filesystem::path fileOf(std::size_t run) const;
  void write(const Record& record) const;

  /// What is known of a run.
  struct Found {
    std::string line;    ///< Empty without a record that can be used.
    std::string damage;  ///< Why the record that is there cannot be used; names the file.
  };
  [[nodiscard]] Found find(std::size_t run) const;

 private:
  std::filesystem::path folder_;
  std::string campaign_;
};

}  // namespace kerfbench::campaign
