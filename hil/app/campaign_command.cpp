// SPDX-License-Identifier: Apache-2.0
#include "hil/app/campaign_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "hil/app/slurm_watch.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/number_from.h"
#include "hil/base/stopwatch.h"
#include "hil/batch/stop_signals.h"
#include "hil/campaign/analysis.h"
#include "hil/campaign/grid.h"
#include "hil/campaign/merge.h"
#include "hil/campaign/runner.h"
#include "hil/cli/run_guarded.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

/// Programs on which a result depends: the bench itself, and its emulators.
constexpr std::array kPrograms{"kerfbench", "kerfbench-avr", "kerfbench-mcs51", "kerfbench-cortex-m"};
constexpr std::size_t kMostShards = 1000;  // Slurm's own limit of an array is 1001 where nobody changed it.

std::string valuesOf(const std::string& base, const std::vector<campaign::FactorValue>& factors) {
  std::string text = base;
  for (const campaign::FactorValue& f : factors) {
    text += fmt::format(", {} {}", f.factor, f.value);
    if (f.size) text += fmt::format(" {:g}", *f.size);
  }
  return text;
}

int listRuns(const campaign::Campaign& campaign, base::Console& console) {
  for (std::size_t i = 0; i < campaign.runs(); ++i) {
    const campaign::RunPlan plan = campaign::planOf(campaign, i);
    console.result(fmt::format("{}: {}{}", i,
                               valuesOf(campaign.bases.at(plan.base).stem().string(), plan.factors),
                               plan.seed ? fmt::format(", seed {}", *plan.seed) : ""));
  }
  console.say(fmt::format("{} runs", campaign.runs()));
  return 0;
}

campaign::BenchFiles benchFiles(const fs::path& bin_dir) {
  campaign::BenchFiles bench{{bin_dir.parent_path() / "firmware"}, {}};
  for (const char* program : kPrograms) bench.programs.push_back(bin_dir / program);
  return bench;
}

/// "2/7"
std::pair<std::size_t, std::size_t> shardFrom(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto shard = base::numberFrom<std::size_t>(text.substr(0, slash));
  const auto shards =
      slash == std::string::npos ? std::nullopt : base::numberFrom<std::size_t>(text.substr(slash + 1));
  if (!shard || !shards || *shard < 1 || *shard > *shards)
    throw base::InputError(fmt::format("--shard {}: is no I/N with 1 <= I <= N", text));
  return {*shard, *shards};
}

campaign::Keep keepFrom(const std::string& text) {
  return text == "all" ? campaign::Keep::kAll : text == "bad" ? campaign::Keep::kBad : campaign::Keep::kNone;
}

/// Runs what is to be run of the campaign here.
int runHere(const campaign::Campaign& campaign, const campaign::Prepared& prepared,
            const CampaignOptions& options, batch::StopSignals& signals, base::Console& console) {
  campaign::ShardOptions shard;
  if (!options.shard.empty()) std::tie(shard.shard, shard.shards) = shardFrom(options.shard);
  shard.at_once = options.jobs > 0 ? options.jobs : options.cores;
  shard.keep = keepFrom(options.keep);
  shard.program = options.bin_dir / kPrograms.front();
  shard.signals = &signals;
  std::size_t made = 0;
  const base::Stopwatch stopwatch;
  shard.remark = [&](const std::string& remark) { console.result("  " + remark); };
  shard.ended = [&](const campaign::Record& record, std::size_t done, std::size_t all) {
    ++made;
    const double left_min =
        stopwatch.total_s() / static_cast<double>(made) * static_cast<double>(all - done) / 60.0;
    console.say(fmt::format("  [{}/{}] run {}: {}  {}", done, all, record.run, record.outcome,
                            valuesOf(record.base, record.factors)));
    (void)std::fflush(stdout);  // A log says how far it is, whatever ends this.
    console.progress(-1.0,
                     fmt::format("{} of {} runs, about {:.0f} min left", done, all, std::ceil(left_min)));
  };
  const campaign::ShardEnd end = campaign::runShard(campaign, prepared, shard);
  console.endProgress();
  for (const std::string& broken : end.broken) console.result(broken);
  if (end.signal) {
    console.result(fmt::format("stopped by signal {}: {} runs have a record; the same command goes on",
                               *end.signal, end.had + end.made));
    return base::kExitWaiting;
  }
  console.say(fmt::format("{} runs made, {} had a record", end.made, end.had));
  return end.broken.empty() ? 0 : base::kExitBroken;
}

int mergeAndTell(const campaign::Prepared& prepared, const campaign::KnownCampaign& known, bool partial,
                 base::Console& console) {
  const campaign::Merged merged = campaign::merge(prepared, known.runs, partial);
  for (const std::string& damaged : merged.damaged) console.result("  damaged: " + damaged);
  if (!merged.isWhole())
    console.result(fmt::format("{} of {} runs have no record: {}", merged.missing.size(), known.runs,
                               campaign::rangesOf(merged.missing)));
  if (merged.digest.empty()) return base::kExitWaiting;
  campaign::Analysis analysis = campaign::analyse(merged.records);
  analysis.name = known.name;
  analysis.title = known.title;
  analysis.identity = prepared.identity;
  analysis.digest = merged.digest;
  analysis.missing = merged.missing;
  campaign::writeAnalysis(analysis, merged.records, prepared.folder);
  for (const std::string& line : campaign::analysisLines(analysis)) console.say("  " + line);
  console.result(fmt::format("{}: digest {}", known.name, merged.digest));
  console.say(fmt::format("page: {}", (prepared.folder / "campaign.html").string()));
  if (merged.isWhole()) campaign::sweep(prepared);
  return merged.isWhole() ? 0 : base::kExitWaiting;
}

SlurmOrder slurmOrder(const campaign::Campaign& campaign, const campaign::Prepared& prepared,
                      const CampaignOptions& options) {
  const std::size_t most = std::min(campaign.runs(), kMostShards);
  SlurmOrder order;
  order.array = {
      .name = campaign.name,
      .shards = options.shards > 0 ? std::min(options.shards, most) : std::min<std::size_t>(most, 100),
      .cpus = std::max(options.jobs, 1),
      .program = options.bin_dir / kPrograms.front(),
      .campaign = campaign.path,
      .folder = prepared.folder,
      .keep = options.keep,
      .options = options.sbatch};
  order.runs = campaign.runs();
  order.poll_s = options.poll_s;
  return order;
}

int runCampaign(const CampaignOptions& options, base::Console& console) {
  if (options.merge) {
    if (options.output.empty() && options.file.empty())
      throw base::InputError("--merge needs the folder of a campaign: --output");
  }
  const std::optional<campaign::Campaign> campaign =
      options.file.empty() ? std::nullopt : std::optional(campaign::readCampaign(options.file));
  const fs::path output =
      options.output.empty() ? options.results / "campaigns" / campaign->name : options.output;
  if (options.list) return listRuns(*campaign, console);
  if (options.merge) {
    const campaign::KnownCampaign known = campaign::knownCampaign(output);
    return mergeAndTell(known.prepared, known, options.partial, console);
  }
  if (!options.shard.empty()) (void)shardFrom(options.shard);
  const campaign::Prepared prepared =
      campaign::prepare(*campaign, output, benchFiles(options.bin_dir), base::progressOn(console));
  console.endProgress();
  batch::StopSignals signals;
  int code = 0;
  if (options.slurm || options.submit) {
    code = handToSlurm(slurmOrder(*campaign, prepared, options), prepared, options.submit, signals, console);
    if (!options.submit || code != 0) return code;
  } else {
    code = runHere(*campaign, prepared, options, signals, console);
    if (!options.shard.empty() || code == base::kExitWaiting) return code;
  }
  const int merged = mergeAndTell(prepared, campaign::knownCampaign(output), options.partial, console);
  if (options.submit && merged == base::kExitWaiting)
    console.result(fmt::format("what the tasks said: {}; the same command submits the rest",
                               (prepared.folder / "slurm" / "*.log").string()));
  return code != 0 ? code : merged;
}

}  // namespace

int campaignCommand(const CampaignOptions& options) {
  return cli::runGuarded(options.file, [&] {
    base::Console console(options.quiet);
    return runCampaign(options, console);
  });
}

}  // namespace kerfbench::app
