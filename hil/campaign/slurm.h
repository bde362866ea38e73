// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kerfbench::campaign {

/// An array of jobs of Slurm, one for each shard.
struct SlurmArray {
  std::string name;      ///< The campaign's.
  std::size_t shards{};  ///< >= 1.
  int cpus{1};           ///< Processors of each shard, and so many runs at a time.
  /// kerfbench, campaign file and folder of results: absolute, and seen by the nodes by the same names.
  std::filesystem::path program, campaign, folder;
  std::string keep;                  ///< Value of --keep.
  std::vector<std::string> options;  ///< For sbatch, as they are: "--partition=night".
};

/// The script for sbatch: an array with a task for each shard, which Slurm queues again when its node fails.
/// @throws std::invalid_argument for an option that is not one line beginning with '-'.
std::string arrayScript(const SlurmArray& array);

/// The number that `sbatch --parsable` printed; nothing where there is none in it.
std::optional<std::string> jobNumberIn(const std::string& output);

/// What the queue says of an array.
struct QueueState {
  bool is_over{};                            ///< Nothing of it is in the queue any more.
  std::map<std::string, std::size_t> tasks;  ///< State, as Slurm names it, and number of tasks in it.
  std::string trouble;                       ///< Why the queue could not be asked; all else is empty then.
};
/// @param exit_code, output  Of `squeue -h -r -j NUMBER -o %T`.
QueueState queueStateIn(int exit_code, const std::string& output);
/// "3 RUNNING, 17 PENDING"
std::string queueWords(const QueueState& state);

/// Runs a program of Slurm, found by PATH, with its output in a file in `folder`.
struct ToolOutput {
  int exit_code{};  ///< 127 where there is no such program.
  std::string output;
};
ToolOutput runTool(const std::vector<std::string>& command, const std::filesystem::path& folder);

}  // namespace kerfbench::campaign
