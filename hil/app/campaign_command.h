// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::app {

struct CampaignOptions {
  std::filesystem::path file;                ///< Campaign file; may be empty with `merge`.
  std::filesystem::path output;              ///< Folder of the results; empty: by the campaign's name.
  std::filesystem::path bin_dir;             ///< Where kerfbench and its children are.
  std::filesystem::path results{"results"};  ///< Folder for results, unless `output` is given.
  int jobs{};                                ///< Runs at a time; 0: `cores` here, one for each task of Slurm.
  int cores{1};                              ///< Processors of this computer.
  std::string shard;                         ///< "2/7"; empty: all runs, then merged.
  std::string keep{"none"};                  ///< "none", "bad", "all"
  bool list{};                               ///< Only says which runs there are.
  bool merge{};                              ///< Runs nothing: brings the records together.
  bool partial{};                            ///< Merges although runs are missing.
  bool slurm{}, submit{};                    ///< Writes the script of an array; submits it, and waits for it.
  std::size_t shards{};                      ///< Tasks of the array; 0: by the number of runs.
  std::vector<std::string> sbatch;
  double poll_s{5.0};  ///< Between two looks at Slurm's queue.
  bool quiet{};
};

/// Runs a campaign, a shard of it, or hands it to Slurm; merges and analyses the records. Returns 0 when all
/// runs that were asked for have a record, base::kExitWaiting when some are missing or it was stopped,
/// base::kExitBroken when some broke.
int campaignCommand(const CampaignOptions& options);

}  // namespace kerfbench::app
