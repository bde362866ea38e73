// SPDX-License-Identifier: Apache-2.0
#include "hil/app/slurm_watch.h"

#include <poll.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/campaign/record.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

/// So often in a row the queue may be out of reach: a controller that is started anew takes minutes.
constexpr int kMostTroubles = 120;

campaign::QueueState askQueue(const std::string& number, const fs::path& folder) {
  const campaign::ToolOutput out =
      campaign::runTool({"squeue", "--noheader", "--array", "--jobs", number, "--format", "%T"}, folder);
  return campaign::queueStateIn(out.exit_code, out.output);
}

std::string submitted(const fs::path& script, const fs::path& folder) {
  const campaign::ToolOutput out = campaign::runTool({"sbatch", "--parsable", script.string()}, folder);
  if (out.exit_code == 127) throw base::InputError("sbatch: no such program: Slurm is not installed here");
  const std::optional<std::string> number = campaign::jobNumberIn(out.output);
  if (out.exit_code != 0 || !number)
    throw base::InputError(fmt::format("sbatch refused {}: {}", script.string(),
                                       base::printable(base::trimmed(out.output), 300)));
  return *number;
}

/// The number of an array of this folder that is in the queue.
std::optional<std::string> arrayInQueue(const fs::path& job_file, const fs::path& folder) {
  const std::optional<std::string> text = base::fileContent(job_file);
  if (!text) return std::nullopt;
  const std::string number(base::trimmed(*text));
  const campaign::QueueState state = askQueue(number, folder);
  if (!state.trouble.empty()) throw base::InputError(fmt::format("squeue: {}", state.trouble));
  return state.is_over ? std::nullopt : std::optional(number);
}

std::size_t recordsIn(const campaign::Prepared& prepared, std::size_t runs) {
  const campaign::RecordFolder records = prepared.records();
  std::size_t count = 0;
  for (std::size_t i = 0; i < runs; ++i) count += fs::exists(records.fileOf(i)) ? 1 : 0;
  return count;
}

/// Waits; true if a signal came.
bool stoppedWhileWaiting(batch::StopSignals& signals, double wait_s) {
  pollfd fd{signals.fd(), POLLIN, 0};
  return ::poll(&fd, 1, static_cast<int>(1e3 * wait_s)) > 0 && signals.take();
}

int watch(const std::string& number, const SlurmOrder& order, const campaign::Prepared& prepared,
          batch::StopSignals& signals, base::Console& console) {
  std::string told;
  int troubles = 0;
  for (;;) {
    const campaign::QueueState state = askQueue(number, prepared.folder / "slurm");
    if (state.is_over) return 0;
    troubles = state.trouble.empty() ? 0 : troubles + 1;
    if (troubles > kMostTroubles) throw base::InputError(fmt::format("squeue: {}", state.trouble));
    const std::string words = state.trouble.empty() ? campaign::queueWords(state) : "queue: " + state.trouble;
    const std::string line = fmt::format("{} of {} runs; array {}: {}", recordsIn(prepared, order.runs),
                                         order.runs, number, words);
    if (line != told) console.say("  " + line);
    (void)std::fflush(stdout);
    told = line;
    if (stoppedWhileWaiting(signals, order.poll_s)) {
      console.result(fmt::format(
          "not waiting any more; array {} goes on, and the same command waits for it again", number));
      return base::kExitWaiting;
    }
  }
}

}  // namespace

int handToSlurm(const SlurmOrder& order, const campaign::Prepared& prepared, bool submit,
                batch::StopSignals& signals, base::Console& console) {
  const fs::path folder = prepared.folder / "slurm", script = folder / "array.sh", job_file = folder / "job";
  fs::create_directories(folder);
  try {
    base::writeFileAtomically(script, campaign::arrayScript(order.array));
  } catch (const std::invalid_argument& e) {
    throw base::InputError(e.what());
  }
  if (!submit) {
    console.result(fmt::format("{}: sbatch takes it; then kerfbench campaign --merge --output {}",
                               script.string(), prepared.folder.string()));
    return 0;
  }
  std::optional<std::string> number = arrayInQueue(job_file, folder);
  if (number) {
    console.say(fmt::format("array {} of this campaign is in the queue: waiting for it", *number));
  } else {
    number = submitted(script, folder);
    base::writeFileAtomically(job_file, *number + "\n");
    console.say(fmt::format("array {}: {} shards", *number, order.array.shards));
  }
  return watch(*number, order, prepared, signals, console);
}

}  // namespace kerfbench::app
