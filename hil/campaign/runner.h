// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/batch/stop_signals.h"
#include "hil/campaign/campaign_file.h"
#include "hil/campaign/identity.h"
#include "hil/campaign/record.h"

namespace kerfbench::campaign {

/// Which results folders stay beside the records.
enum class Keep { kNone, kBad, kAll };

/// How the runs of a shard are made.
struct ShardOptions {
  std::size_t shard{1}, shards{1};  ///< 1 <= shard <= shards.
  int at_once{1};                   ///< So many runs at a time.
  Keep keep{Keep::kNone};  ///< kBad: of runs that are not PASS. In the campaign's folder, as kept/NUMBER.
  std::filesystem::path program;  ///< kerfbench, absolute.
  batch::StopSignals* signals{};  ///< Stops the shard; may be null.
  /// A run has a record now; `done` of `all` in this shard have one.
  std::function<void(const Record& record, std::size_t done, std::size_t all)> ended{};
  std::function<void(const std::string& remark)> remark{};
};

/// How a shard ended.
struct ShardEnd {
  std::size_t had{};   ///< Runs that had a record before.
  std::size_t made{};  ///< Runs that were made.
  std::vector<std::string>
      broken;                 ///< Runs that broke in a way that another try may mend: they have no record.
  std::optional<int> signal;  ///< The signal that stopped it.
};

/// Makes the runs of a shard that have no record yet, each as a child process `kerfbench run`, and writes
/// their records. A damaged record is told and made again. May be stopped at any time in any way and called
/// again, here or on another computer that sees the folder; two that make the same run write the same bytes.
///
/// A run that breaks (exit code 2, a signal) is tried once more. If the bench breaks again with the same
/// words the record says so (kBroken); otherwise there is none.
/// @throws std::system_error where a folder cannot be written.
ShardEnd runShard(const Campaign& campaign, const Prepared& prepared, const ShardOptions& options);

/// Removes what interrupted shards left, once all runs have their records.
void sweep(const Prepared& prepared);

/// Why a run has no verdict, by what it said on standard error: its first line, with file names without their
/// folders, which differ from computer to computer.
std::string reasonIn(const std::string& log);

}  // namespace kerfbench::campaign
