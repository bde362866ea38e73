// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/slurm.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "hil/base/file_content.h"
#include "hil/base/text.h"
#include "hil/batch/job_process.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;

/// A word for the shell, whatever is in it.
std::string shellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> linesIn(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (const auto line = base::trimmed(std::string_view(text).substr(at, end - at)); !line.empty())
      lines.emplace_back(line);
    at = end + 1;
  }
  return lines;
}

}  // namespace

std::string arrayScript(const SlurmArray& array) {
  std::string script = fmt::format(
      "#!/bin/sh\n"
      "# Written by kerfbench campaign. A task is a shard; it may be run again at any time.\n"
      "#SBATCH --job-name={}\n"
      "#SBATCH --array=1-{}\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task={}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output={}\n",
      array.name, array.shards, array.cpus, (array.folder / "slurm" / "%A_%a.log").string());
  for (const std::string& option : array.options) {
    if (!option.starts_with("-") || option.find_first_of("\n\r") != std::string::npos)
      throw std::invalid_argument(
          fmt::format("{} is no option of sbatch: --name=value", base::inQuotes(option)));
    script += fmt::format("#SBATCH {}\n", option);
  }
  return script +
         fmt::format(
             "exec {} campaign {} --output {} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --jobs {} --keep {}\n",
             shellQuoted(array.program.string()), shellQuoted(array.campaign.string()),
             shellQuoted(array.folder.string()), array.shards, array.cpus, array.keep);
}

std::optional<std::string> jobNumberIn(const std::string& output) {
  for (const std::string& line : linesIn(output)) {
    const std::string number = line.substr(0, line.find(';'));  // "17;cluster" where there are several.
    if (!number.empty() && number.find_first_not_of("0123456789") == std::string::npos) return number;
  }
  return std::nullopt;
}

QueueState queueStateIn(int exit_code, const std::string& output) {
  QueueState state;
  // A controller forgets jobs that ended some minutes ago (MinJobAge).
  if (exit_code != 0 && output.find("Invalid job id") == std::string::npos) {
    state.trouble = base::printable(base::trimmed(output), 200);
    if (state.trouble.empty()) state.trouble = fmt::format("squeue ended with exit code {}", exit_code);
    return state;
  }
  if (exit_code == 0)
    for (const std::string& line : linesIn(output)) ++state.tasks[line];
  state.is_over = state.tasks.empty();
  return state;
}

std::string queueWords(const QueueState& state) {
  std::string words;
  for (const auto& [name, count] : state.tasks)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, name);
  return words;
}

ToolOutput runTool(const std::vector<std::string>& command, const fs::path& folder) {
  const fs::path log = folder / (command.front() + ".log");
  fs::remove(log);
  std::vector<std::string> whole{"/usr/bin/env"};
  whole.insert(whole.end(), command.begin(), command.end());
  batch::JobProcess process(whole, log);
  const batch::JobEnd end = process.finish();
  const std::string output = base::fileContent(log).value_or("");
  return {end.how == batch::JobEnd::How::kExited ? end.code : -1, output};
}

}  // namespace kerfbench::campaign
