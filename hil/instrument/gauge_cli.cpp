// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/installation.h"
#include "hil/cli/program.h"
#include "hil/instrument/cli.h"
#include "hil/instrument/gauge_command.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::instrument {

namespace {

void addCounts(CLI::App* gauge, gauge::GaugeOptions& g) {
  const auto count = CLI::Range(0, 1000000);
  CLI::Option* cases = gauge
                           ->add_option_function<std::size_t>(
                               "--cases", [&g](std::size_t each) { g.coverage = g.still = each; },
                               "Cases of coverage and of stillness, for each preset (1000)")
                           ->check(count);
  CLI::Option* bad = gauge->add_option("--bad", g.bad, "Cuts of 55 to 120 um, over all presets")
                         ->check(count)
                         ->capture_default_str();
  CLI::Option* good = gauge->add_option("--good", g.good, "Cuts of 0 to 40 um, over all presets")
                          ->check(count)
                          ->capture_default_str();
  gauge
      ->add_flag_function(
          "--quick",
          [&g](std::int64_t) {
            g.bad = g.good = 300;
            g.coverage = 60;
            g.still = 100;
            g.repeats = g.still_repeats = 25;
          },
          "300 bad and 300 good cuts and few others: two minutes; too few for what needs 1000 cases")
      ->excludes(cases)
      ->excludes(bad)
      ->excludes(good);
}

}  // namespace

void addGauge(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<GaugeCommandOptions>();
  GaugeCommandOptions& options = *holder;
  options.command_line = program.command_line;
  options.gauge.jobs = program.jobs;
  options.results_dir = program.results;
  if (base::isInstalled(program.bin_dir))
    options.machine = base::shippedData(program.bin_dir) / "machines" / "two-mirror.yaml";
  CLI::App* gauge = app.add_subcommand(cli::kGauge.name, cli::kGauge.help);
  gauge->add_option("MACHINE", options.machine, "Machine file, whose cameras are gauged")
      ->capture_default_str();
  gauge::GaugeOptions& g = options.gauge;
  addCounts(gauge, g);
  gauge
      ->add_option_function<std::string>(
          "--imperfections",
          [&g](const std::string& which) {
            if (which != "both") g.presets = {scenario::presetFromName(which)};
          },
          "Machines to draw: ideal, static, dynamic or both (static and dynamic, the default)")
      ->check(CLI::IsMember({"ideal", "static", "dynamic", "both"}));
  gauge->add_flag(
      "--mismatch", options.mismatch,
      "Cut and look in worlds that are not the bench's own: other light, walls, beam, lens, board "
      "and print than\nit is told");
  gauge->add_option("--studies", options.studies, "Only these: verdicts, coverage, type1, grr, stillness")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kGaugeStudies.begin(), kGaugeStudies.end())));
  gauge->add_option("--case", options.test_case,
                    "Repeat one case, like static-bad-17, and write its picture");
  gauge->add_option("--seed", g.seed, "Of everything that is drawn")->capture_default_str();
  gauge->add_option("--results-dir", options.results_dir, "Folder for the results")->capture_default_str();
  gauge->add_option("--jobs,-j", g.jobs, "Threads; the results are the same at any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  gauge->add_flag("--quiet,-q", options.quiet, "Only the claims that do not hold");
  actions.add(gauge, std::move(holder), gaugeCommand);
}

}  // namespace kerfbench::instrument
