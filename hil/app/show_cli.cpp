// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>

#include "hil/app/cli.h"
#include "hil/app/show_command.h"

namespace kerfbench::app {
namespace {

// "1280x800"
std::string readSize(const std::string& text, ShowOptions& options) {
  const auto cross = text.find('x');
  const auto number = [](const std::string& digits) {
    const bool plain =
        !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string::npos;
    return plain ? std::stoi(digits) : 0;
  };
  options.width_px = cross == std::string::npos ? 0 : number(text.substr(0, cross));
  options.height_px = cross == std::string::npos ? 0 : number(text.substr(cross + 1));
  const bool good = std::min(options.width_px, options.height_px) >= 64 &&
                    std::max(options.width_px, options.height_px) <= 8192;
  return good ? "" : "is to be WIDTHxHEIGHT in pixels, 64 to 8192 each";
}

void addFilmOptions(CLI::App& show, ShowOptions& options) {
  CLI::Option* film = show.add_option(
      "--film", options.film,
      "A film of the machine, .mp4 or .webm, by FFmpeg: SUBJECT is a trace (run.mcap) or a "
      "scenario, which is run. Without --from\nand --to it shows a cycle: a gantry once forth "
      "and back, under a head that stands still one unit");
  show.add_option("--from", options.from_s, "The film begins here, simulated s")
      ->needs(film)
      ->check(CLI::NonNegativeNumber);
  show.add_option("--to", options.to_s, "The film ends here, simulated s")
      ->needs(film)
      ->check(CLI::NonNegativeNumber);
  show.add_option("--slow", options.slow, "A second of the run takes so many of the film")
      ->needs(film)
      ->check(CLI::Range(0.01, 1e5))
      ->capture_default_str();
  show.add_option("--fps", options.pictures_each_s, "Pictures a second of the film")
      ->needs(film)
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  show.add_option("--jobs,-j", options.threads, "Threads that draw a film")
      ->needs(film)
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

}  // namespace

void addReadingOptions(CLI::App& command, dieline::DrawingArguments& arguments) {
  command.add_option("--unit", arguments.unit,
                     "What a unit of the drawing is: mm, cm, in, pt or px (1/96 in)");
  command.add_option("--page", arguments.page, "Page of a PDF that has several")->check(CLI::Range(1, 9999));
  command.add_option("--scale", arguments.scale, "Enlarge the drawing so many times")->capture_default_str();
  command.add_option("--turn", arguments.turn_deg, "Turn it about the origin, degrees counter-clockwise")
      ->capture_default_str();
  command.add_option("--shift", arguments.shift_mm, "Move it by x and y, mm")->expected(2);
  command.add_flag("--once", arguments.once, "Leave out lines that lie wholly on another of their process");
  command.add_option("--layer", arguments.layers,
                     "What a layer is for, in place of the usual names: CUT=cut, '*/color/1=cut', "
                     "'*/linetype/DASHED=perforation', '*/other=ignore'; may be given often");
}

void addShow(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  auto holder = std::make_shared<ShowOptions>();
  ShowOptions& options = *holder;
  options.bin_dir = program.bin_dir;
  options.threads = program.jobs;
  CLI::App* show = app.add_subcommand("show",
                                      "Draw a machine at rest or in the middle of a run (PNG), or what a "
                                      "drawing has the laser do and what lint finds in it (SVG or PNG)");
  show->add_option("SUBJECT", options.subject,
                   "Machine file, which may be left out where --scenario names it; or a drawing");
  CLI::Option* scenario = show->add_option(
      "--scenario", options.scenario,
      "Run this, and draw the machine as it is then; for a drawing, read it by the rules of this");
  show->add_option("--at", options.at_s,
                   "Virtual seconds, one or several; otherwise in the middle of the longest cut")
      ->needs(scenario)
      ->check(CLI::NonNegativeNumber);
  show->add_option("--out", options.out,
                   "PNG file, for a drawing .svg or .png; several times are added to its name");
  show->add_option_function<std::string>(
          "--size",
          [&options](const std::string& text) {
            const std::string fault = readSize(text, options);
            if (!fault.empty()) throw CLI::ValidationError("--size", fault);
          },
          "Pixels, 1280x800 unless told; a drawing's picture has the width alone")
      ->type_name("WxH");
  show->add_option("--view", options.view,
                   "overall, head (mirrors or carriage) or sheet (the board from above)")
      ->check(CLI::IsMember({"overall", "head", "sheet"}))
      ->capture_default_str();
  addFilmOptions(*show, options);
  addReadingOptions(*show, options.drawing);
  show->add_flag("--quiet,-q", options.quiet, "Only the names of the files");
  actions.add(show, std::move(holder), showCommand);
}

}  // namespace kerfbench::app
