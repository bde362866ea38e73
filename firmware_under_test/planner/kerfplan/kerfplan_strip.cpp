// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_strip.h"

#include <filesystem>
#include <map>
#include <string>

#include <fmt/format.h>

#include "firmware_under_test/planner/kerfplan/output_text.h"
#include "firmware_under_test/planner/strip/strip_path.h"
#include "firmware_under_test/planner/strip/strip_pictures.h"
#include "firmware_under_test/planner/strip/throughput.h"
#include "hil/base/terminal.h"

namespace kerfbench::planner {

struct StripCommands::Options {
  double width_mm{800.0};
  StripMethod method{StripMethod::kContinuous};
  std::string feed_profile;
  int pieces{2};
  double every_s{0.01};
  std::string output, pictures;
};

namespace {

namespace fs = std::filesystem;

/// Writes a chart into a folder, which is made if need be.
void writeChart(const fs::path& folder, const char* name, const std::string& svg) {
  fs::create_directories(folder);
  writeOutput(folder / name, svg);
}

CrossCut crossCutOf(double width_mm, const MachineParameters& machine, const JobParameters& job) {
  return {job.pitch_mm,
          width_mm,
          machine.field_max_mm[0] - machine.field_min_mm[0],
          job.belt_speed_mm_s,
          job.mark_speed_mm_s,
          job.jump_speed_mm_s};
}

}  // namespace

StripCommands::StripCommands(CLI::App& app, const MachineParameters& machine, const JobParameters& job,
                             const std::function<void(CLI::App&)>& add_options)
    : machine_(machine), job_(job), options_(std::make_shared<Options>()) {
  throughput_ = app.add_subcommand(
      "throughput",
      "Compare, for a strip cut to length, feeding and stopping with cutting on the run, by formula and as\n"
      "planned with ramps: highest feed, time for 1 to 10 000 pieces of --pitch mm at --belt-speed,\n"
      "--mark-speed across, --jump-speed back");
  path_ = app.add_subcommand("strip-path",
                             "Print the head's way G(t) over a strip that is cut to length, without ramps: "
                             "where it is, how fast, how\n"
                             "far it has gone (Hu, Hu, Jiang 2014, eq. 2 to 5)");
  for (CLI::App* command : {throughput_, path_}) {
    command->add_option("--width", options_->width_mm, "Of the strip, mm")->capture_default_str();
    command->add_option("--pictures", options_->pictures, "Folder for the charts, SVG");
    add_options(*command);
  }
  const std::map<std::string, StripMethod> methods{{"stop-and-go", StripMethod::kStopAndGo},
                                                   {"continuous", StripMethod::kContinuous},
                                                   {"mean-speed", StripMethod::kMeanSpeed}};
  CLI::Option* const method = path_->add_option("--method", options_->method,
                                                "stop-and-go (eq. 3), continuous (eq. 4) or mean-speed (eq. "
                                                "5: goes along at the mean of --feed-profile)");
  method->transform(CLI::CheckedTransformer(methods, CLI::ignore_case))->default_str("continuous");
  path_->add_option("--feed-profile", options_->feed_profile,
                    "Speed of the strip over time, instead of --belt-speed: 0:200,1.8:200,2:202.2 (s:mm/s), "
                    "linear in between (mean-speed)");
  path_->add_option("--pieces", options_->pieces, "Pieces to cut")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  path_->add_option("--every", options_->every_s, "Time between the rows of --output, s")
      ->check(CLI::Range(1e-5, 1e3))
      ->capture_default_str();
  path_->add_option("-o,--output", options_->output, "Table of the whole way, CSV");
}

bool StripCommands::run() const {
  const Options& o = *options_;
  const CrossCut cut = crossCutOf(o.width_mm, machine_, job_);
  const fs::path pictures = o.pictures;
  if (throughput_->parsed()) {
    base::toTerminal(stdout, throughputTable(cut, machine_, job_));
    if (!pictures.empty())
      writeChart(pictures, "strip-time.svg", throughputPicture(throughputOf(cut, machine_, job_)));
    return true;
  }
  if (!path_->parsed()) return false;
  const bool varies = o.method == StripMethod::kMeanSpeed;
  if (varies == o.feed_profile.empty())
    throw PlanError(varies ? "--method mean-speed needs a --feed-profile"
                           : "--feed-profile is for --method mean-speed");
  const StripPath path(cut, o.method, varies ? StripFeed::parse(o.feed_profile) : StripFeed(cut.feed_mm_s),
                       o.pieces);
  base::toTerminal(stdout, stripSpans(path));
  if (varies)
    base::toTerminal(stdout,
                     fmt::format("the head leaves the line that the strip carries by {:.3f} mm at most\n",
                                 path.farthestOffMm()));
  if (!o.output.empty()) writeOutput(o.output, stripTable(path, o.every_s));
  if (!pictures.empty()) {
    writeChart(pictures, "strip-way.svg", stripPathPicture(path));
    writeChart(pictures, "strip-length.svg", stripLengthPicture(path));
  }
  return true;
}

}  // namespace kerfbench::planner
