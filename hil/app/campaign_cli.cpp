// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include "hil/app/campaign_command.h"
#include "hil/app/cli.h"

namespace kerfbench::app {
namespace {

void addSlurmOptions(CLI::App& command, CampaignOptions& options) {
  command.add_flag("--slurm", options.slurm,
                   "Write an array of jobs for Slurm (OUTPUT/slurm/array.sh) instead of running here");
  command.add_flag(
      "--submit", options.submit,
      "Give that array to sbatch, wait until it has left the queue, and merge. If an array of this "
      "folder\nis in the queue already, wait for that");
  command
      .add_option("--shards", options.shards, "Tasks of the array, by default one for each run, at most 100")
      ->check(CLI::Range(1, 1000));
  command
      .add_option("--sbatch", options.sbatch,
                  "An option of sbatch as it is, may be given often: --sbatch=--partition=night")
      ->allow_extra_args(false);
  command.add_option("--poll", options.poll_s, "Seconds between two looks at Slurm's queue")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
}

}  // namespace

void addCampaign(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<CampaignOptions>();
  options->bin_dir = program.bin_dir;
  options->results = program.results;
  options->cores = program.jobs;
  CLI::App* command = app.add_subcommand(
      "campaign",
      "Many runs by a campaign file: a grid, or random draws, of faults, keys of scenario and machine, and "
      "seeds; "
      "here,\n"
      "in shards on several computers, or on Slurm. Runs that have a record are not made again. Then: pass "
      "rate by\n"
      "factor, smallest fault found, thin margins, as page and JSON. Exit code 75: runs are missing yet.");
  command->add_option("FILE", options->file,
                      "Campaign file (fixtures/campaigns/*.yaml); not needed with --merge");
  command->add_option("--output,-o", options->output,
                      "Folder for records, page and JSON, by default results/campaigns/NAME");
  command
      ->add_option("--jobs,-j", options->jobs,
                   "Runs at a time: here by default as many as there are processors, of a task of Slurm one")
      ->check(CLI::Range(1, 256));
  command->add_option("--shard", options->shard, "I/N: every N-th run, from the I-th; nothing is merged");
  command->add_flag("--merge", options->merge, "Run nothing: bring the records together and analyse them");
  command->add_flag("--partial", options->partial, "Merge although runs are missing; the page says which");
  command->add_flag("--list", options->list, "Only say which runs there are, with their values");
  command->add_option("--keep", options->keep, "Results folders that stay, as OUTPUT/kept/NUMBER")
      ->check(CLI::IsMember(std::vector<std::string>{"none", "bad", "all"}))
      ->capture_default_str();
  addSlurmOptions(*command, *options);
  command->add_flag("--quiet,-q", options->quiet, "Only the digest, and what is wrong");
  command->final_callback([=] {
    if (options->file.empty() && !options->merge) throw CLI::RequiredError("FILE");
    if (!options->shard.empty() && (options->merge || options->slurm || options->submit || options->list))
      throw CLI::ExcludesError("--shard", "--merge, --list, --slurm, --submit");
  });
  actions.addStopping(command, [options] { return campaignCommand(*options); });
}

}  // namespace kerfbench::app
