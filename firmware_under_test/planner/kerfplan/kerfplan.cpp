// SPDX-License-Identifier: Apache-2.0
// kerfplan: the host half of the reference controller as a program of its own.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/kerfplan/drawing_options.h"
#include "firmware_under_test/planner/kerfplan/idle_options.h"
#include "firmware_under_test/planner/kerfplan/input_text.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_compensate.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_library.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_loop.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_own_job.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_power.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_strip.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_summary.h"
#include "firmware_under_test/planner/kerfplan/output_text.h"
#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "firmware_under_test/planner/preview/preview.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/order_table.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/program.h"
#include "firmware_under_test/planner/program/selection.h"
#include "hil/base/console.h"
#include "hil/base/terminal.h"
#include "hil/base/version.h"
#include "hil/command_line/dialogue_cli.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace {

using namespace kerfbench;
using planner::JobParameters;
using planner::MachineParameters;

constexpr int kBadInput = 65;
constexpr int kBroken = 2;

struct Options {
  std::string input;
  std::string output;
  std::string entities, layers, processes;  ///< Selections as typed; empty: all.
  dieline::DrawingArguments drawing;
  std::string correction;  ///< File of the table.
  std::string image;       ///< Release image of the controller; empty: the AVR release.
  planner::PowerOptions power;
  planner::OwnJobOptions own_job;
  planner::LoopCase loop;  ///< Tube and meter, for power-loop.
  MachineParameters machine{.head = MachineParameters::Head::kTwoMirror,
                            .throw_mm = 500.0,
                            .mirror_spacing_mm = 15.0,
                            .mirror_step_rad = 12.5e-6,
                            .gantry_step_mm = 0.0125,
                            .field_min_mm = {-80.0, -80.0},
                            .field_max_mm = {80.0, 80.0},
                            .tracking_delay_s = 0.19e-3,
                            .encoder_count_mm = 0.01,
                            .print_mark_sensor_x_mm = -150.0,
                            .feed_step_mm = 0.0,
                            .full_power_w = 200.0};
  JobParameters job{.cut_energy_j_per_mm = 0.3};
};

bool isGcode(const std::string& path) {
  if (path == planner::kStandardInput) return true;
  const std::string tail = path.substr(std::min(path.size(), path.find_last_of('.')));
  return std::set<std::string>{".nc", ".ngc", ".gcode", ".tap", ".txt"}.count(CLI::detail::to_lower(tail)) >
         0;
}

dieline::Dieline readInput(const Options& options) {
  base::Console console(false);
  dieline::DrawingOptions drawing = dieline::drawingOptionsFrom(options.drawing);
  drawing.progress = base::progressOn(console);
  dieline::Dieline dieline = dieline::readDieline(options.input, drawing);
  console.endProgress();
  for (const std::string& note : dieline.notes) base::toTerminal(stderr, "note: " + note + "\n");
  if (dieline.entities.empty()) throw planner::PlanError(options.input + ": no entities");
  return dieline;
}

dieline::Dieline chosenOf(const Options& options) {
  dieline::Dieline dieline = readInput(options);
  planner::select(dieline, planner::selectionFrom(options.entities, options.layers, options.processes));
  return dieline;
}

std::string gcodeOf(const Options& options) {
  const bool compensates = options.job.kerf_radius_mm > 0.0;
  if (isGcode(options.input)) {
    if (!options.drawing.empty())
      throw planner::PlanError(options.input +
                               ": --unit, --scale, --turn, --shift and --layer are for drawings");
    if (compensates)
      throw planner::PlanError(options.input + ": G-code is the beam's path, --kerf-radius is for drawings");
    return planner::select(planner::inputText(options.input),
                           planner::selectionFrom(options.entities, options.layers, options.processes));
  }
  const dieline::Dieline dieline = chosenOf(options);
  std::string gcode = planner::makeGcode(dieline, options.machine, options.job);
  if (compensates) {
    for (const std::string& note : planner::compensate(dieline, options.job).notes)
      base::toTerminal(stderr, note + "\n");
  }
  return gcode;
}

/// Faults of G-code, each with the name of its file.
std::string withFile(const Options& options, const std::string& faults) {
  if (!isGcode(options.input)) return faults;
  std::string named;
  for (std::size_t at = 0; at < faults.size();) {
    const std::size_t end = std::min(faults.find('\n', at), faults.size());
    const std::string line = faults.substr(at, end - at);
    named += (named.empty() ? "" : "\n") + (line.starts_with("G-code") ? options.input + ": " : "") + line;
    at = end + 1;
  }
  return named;
}

/// Prints all errors to standard error, or the demands of the job.
int check(const Options& options, const std::string& gcode) {
  const planner::CheckResult checked = planner::checkJob(gcode, options.machine, options.job);
  for (const std::string& warning : checked.warnings) base::toTerminal(stderr, "warning: " + warning + "\n");
  for (const std::string& error : checked.errors) base::toTerminal(stderr, withFile(options, error) + "\n");
  if (!checked.errors.empty()) return kBadInput;
  base::toTerminal(stdout, planner::summaryOf(options.input, checked,
                                              planner::planFromGcode(gcode, options.machine, options.job),
                                              options.machine, options.job));
  return 0;
}

void addMachine(CLI::App& app, Options& options) {
  MachineParameters& m = options.machine;
  const std::map<std::string, MachineParameters::Head> heads{
      {"two-mirror", MachineParameters::Head::kTwoMirror},
      {"gantry", MachineParameters::Head::kGantry},
      {"f-theta", MachineParameters::Head::kFTheta}};
  const std::string group = "Machine";
  const auto option = [&](const char* name, double& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  app.add_option("--head", m.head,
                 "What moves the beam: two-mirror, f-theta (two mirrors and a lens) or gantry")
      ->transform(CLI::CheckedTransformer(heads, CLI::ignore_case))
      ->default_str("two-mirror")
      ->group(group);
  option("--throw", m.throw_mm, "Y mirror to sheet, mm (two-mirror)");
  option("--mirror-spacing", m.mirror_spacing_mm, "X mirror to Y mirror, mm (two-mirror)");
  option("--mirror-step", m.mirror_step_rad, "Mechanical angle of one step, rad (two-mirror, f-theta)");
  option("--focal-length", m.focal_length_mm, "Of the lens, mm (f-theta)");
  option("--mirror-acceleration", m.mirror_acceleration_rad_s2,
         "Highest of either mirror, rad/s2 mechanical; 0: never the limit (two-mirror)");
  option("--full-step-pulses", m.steppers.full_step_pulses,
         "Steppers on the mirrors: pulses for a full step; 0: none (two-mirror, f-theta)");
  option("--detent-share", m.steppers.detent_share,
         "Their detent torque over their holding torque, which the steps then make up for; needs "
         "--full-step-pulses");
  option("--rotor-resonance", m.steppers.resonance_hz,
         "Frequency of their rotors, Hz: steps are chosen so that these do not swing; 0: the nearest steps");
  option("--rotor-damping", m.steppers.resonance_damping, "Damping of the same, share of critical");
  option("--gantry-step", m.gantry_step_mm, "Way of one step, mm (gantry)");
  option("--x-min", m.field_min_mm[0], "Reach of the beam upstream, mm");
  option("--x-max", m.field_max_mm[0], "Reach of the beam downstream, mm");
  option("--y-min", m.field_min_mm[1], "Reach of the beam across, mm");
  option("--y-max", m.field_max_mm[1], "Reach of the beam across, mm");
  option("--tracking-delay", m.tracking_delay_s, "Lag of mirrors or gantry behind their steps, s");
  option("--encoder-count", m.encoder_count_mm, "Belt travel of one encoder count, mm");
  option("--print-mark-sensor", m.print_mark_sensor_x_mm, "Place of the print-mark sensor, x in mm");
  option("--feed-step", m.feed_step_mm, "Belt travel of one feed step, mm");
  option("--full-power", m.full_power_w, "Laser power at full duty, W");
  app.add_option(
         "--image", options.image,
         "The controller's release, .hex, .elf or native: tick, period, steps in a period, pulse times "
         "and delays are planned as it says; not told: those of the AVR release")
      ->group(group);
}

/// A way to find an order by its name, or entities as they are typed.
void readOrder(const std::string& words, JobParameters& job) {
  const std::map<std::string, JobParameters::Order> names{{"shortest", JobParameters::Order::kShortest},
                                                          {"nearest", JobParameters::Order::kNearest},
                                                          {"drawn", JobParameters::Order::kDrawn}};
  if (const auto found = names.find(CLI::detail::to_lower(words)); found != names.end()) {
    job.order = found->second;
    return;
  }
  try {
    job.given_order = planner::idsOf(planner::entityRangesFrom(words, "--order"), planner::kMostOrdered);
    job.order = JobParameters::Order::kGiven;
  } catch (const planner::PlanError& error) {
    throw CLI::ValidationError("--order",
                               fmt::format("shortest, nearest, drawn, or entities: {}", error.what()));
  }
}

void addJob(CLI::App& app, JobParameters& j) {
  const std::string group = "Job";
  const auto option = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  option("--belt-speed", j.belt_speed_mm_s, "Speed of the sheet, mm/s; 0: it rests");
  option("--belt-min", j.belt_min_mm_s, "Lowest speed that the belt may have, mm/s; 0: not checked");
  option("--belt-max", j.belt_max_mm_s, "Highest speed that the belt may have, mm/s; 0: not checked");
  option("--mark-speed", j.mark_speed_mm_s, "Highest speed of marks on the sheet, mm/s");
  option("--jump-speed", j.jump_speed_mm_s, "Highest speed of jumps and of the way back, mm/s");
  option("--acceleration", j.acceleration_mm_s2, "Highest acceleration, mm/s2");
  option("--jerk", j.jerk_mm_s3,
         "Most change of acceleration, mm/s3: S-curves in marks and jumps; 0: no limit");
  option("--jump-acceleration", j.jump_acceleration_mm_s2,
         "Of jumps and of the way back, mm/s2; 0: as of marks");
  option(
      "--jump-radius", j.jump_radius_mm,
      "Arcs by which jumps leave and meet marks, mm: the beam does not stop; 0: straight jumps with stops; "
      "-1: by the drawing's size, 1 mm up to 10 mm, 5 mm from 100 mm on");
  option("--run-up", j.run_up_mm,
         "Way before and behind marks, along their tangent with the laser off, mm: marks begin and end at "
         "speed; "
         "0: none; -1: as long as the speed takes");
  option(
      "--corner-error", j.corner_error_mm,
      "How far the beam may miss a corner so as not to stop there, mm: turns below a right angle are rounded "
      "by that at most, lag of the drives included; 0: none is");
  option("--cut-energy", j.cut_energy_j_per_mm, "Energy per length that cuts through (Z1), J/mm");
  option("--half-z", j.half_z, "Z of half-cuts and creases, 0 to 1");
  option("--perforation-cut", j.perforation_cut_mm, "Length of a dash, mm");
  option("--perforation-gap", j.perforation_gap_mm, "Length between dashes, mm");
  option("--units", j.units, "Units on the web");
  option("--pitch", j.pitch_mm, "Distance of units on the web, mm");
  option("--eye-mark", j.eye_mark_x_mm, "Leading edge of the eye mark in the unit, x in mm");
  option("--web-start", j.web_start_x_mm,
         "x of unit 0's origin while the belt rests, mm (belt speed 0, or --feed)");
  option("--feed-acceleration", j.feed_acceleration_mm_s2, "With --feed: acceleration of the belt, mm/s2");
  app.add_option_function<std::string>(
         "--order", [&j](const std::string& words) { readOrder(words, j); },
         "Order of a drawing's lines: shortest (air path), nearest (end, greedily), drawn, or the entities "
         "themselves: 3,0,5-8")
      ->type_name("ORDER")
      ->default_str("shortest")
      ->group(group);
  planner::addKerfOptions(app, j);
  app.add_flag("--alternate", j.alternate, "Cut every second unit backwards")->group(group);
  app.add_flag("--stop-and-go", j.stop_and_go,
               "With --feed: feed a pitch at the belt speed, stop, cut at rest")
      ->group(group);
  app.add_flag("--feed", j.feed_by_controller, "The controller drives the belt")->group(group);
}

/// Adds a command that takes a drawing or G-code.
CLI::App* jobCommand(CLI::App& app, Options& options, const char* name, const char* help, bool writes) {
  CLI::App* sub = app.add_subcommand(name, help);
  sub->add_option(
         "DIELINE", options.input,
         "A drawing (.dxf, .svg, .pdf, .cf2), or G-code (.nc, .ngc, .gcode, .tap, .txt; - from standard "
         "input)")
      ->required();
  if (writes) sub->add_option("-o,--output", options.output, "File to write instead of standard output");
  const auto choice = [&](const char* option, std::string& value, const char* meaning) {
    sub->add_option(option, value, meaning)->group("What is cut (all, if nothing is said)");
  };
  choice("--entities", options.entities, "Only these entities, by id: 3,5-8");
  choice("--layers", options.layers, "Only these layers (or SVG colours) of a drawing: cut,crease");
  choice("--process", options.processes, "Only these processes: cut, half-cut, crease, perforation");
  planner::addDrawingOptions(*sub, options.drawing);
  addMachine(*sub, options);
  sub->add_option("--correction", options.correction,
                  "CSV table of what the head's formula leaves: x_mm,y_mm,dx_mm,dy_mm")
      ->group("Machine");
  addJob(*sub, options.job);
  planner::addPowerOptions(*sub, options.power);
  sub->final_callback([sub, &options] {
    planner::refuseIdleOptions(*sub, {options.machine, options.job, options.power, isGcode(options.input)});
  });
  return sub;
}

/// Commands as parsed.
struct Commands {
  const CLI::App* gcode;
  const CLI::App* program;
  const CLI::App* preview;
  const CLI::App* order;
  const CLI::App* power_loop;
};

Commands addCommands(CLI::App& app, Options& options) {
  const auto subcommand = [&](const char* name, const char* help, bool writes) {
    return jobCommand(app, options, name, help, writes);
  };
  const CLI::App* gcode = subcommand("gcode", "Write the G-code of one unit, to read or to edit", true);
  CLI::App* program = subcommand(
      "program", "Write the controller's program of all units: an operation per line in hex, or in C", true);
  planner::addOwnJobOptions(*program, options.own_job);
  const CLI::App* preview = subcommand(
      "preview", "Write a page that plays the job: one HTML file, nothing loaded from elsewhere", true);
  const CLI::App* order = subcommand(
      "order", "Compare the orders in which a drawing can be cut: air path, time, highest belt speed", false);
  subcommand("check", "Say whether and how the job fits the machine", false);
  CLI::App* loop = subcommand(
      "power-loop",
      "Compare laws of the loop on the measured power over the marks of a job (with --material, --laser and "
      "--depth): the paper's P(k+1) = P(k) + (P_out - P_f) and the damped one; with -o as a plot (SVG)",
      true);
  loop->add_option("--tube", options.loop.tube, "Power of the tube over its nominal one")
      ->capture_default_str();
  loop->add_option("--late", options.loop.late_periods, "Periods until a measurement can be used")
      ->capture_default_str();
  return {gcode, program, preview, order, loop};
}

/// Compares laws of the power loop over all marks of one unit.
void comparePowerLoops(const Options& options, const std::string& gcode) {
  if (!options.job.power) throw planner::PowerError("power-loop needs --material, --laser and --depth");
  const planner::CheckResult checked = planner::checkJob(gcode, options.machine, options.job);
  if (!checked.solution) throw planner::PlanError(fmt::format("{}", fmt::join(checked.errors, "\n")));
  planner::LoopCase loop = options.loop;
  const planner::LaserTube& laser = options.job.power->laser();
  loop.limits = {laser.least_w, laser.most_w};
  loop.period_s = options.machine.target.periodS();
  std::vector<double> wanted_w;
  for (const planner::Block& block : checked.solution->paths.front().blocks) {
    for (const planner::Sample& sample : block.samples) {
      if (sample.marked_mm > 0.0)
        wanted_w.push_back(planner::powerSetting(sample, options.machine, options.job).power_w);
    }
  }
  if (!options.output.empty()) {
    planner::writeOutput(options.output, planner::loopPlot(wanted_w, loop));
    if (options.output == "-") return;
  }
  base::toTerminal(stdout, planner::loopTable(wanted_w, loop));
}

/// Runs the commands; returns the exit code.
int run(const Commands& commands, const planner::StripCommands& strip, Options& options) {
  if (!options.image.empty()) options.machine.target = planner::targetOfImage(options.image);
  if (strip.run()) return 0;
  if (!options.correction.empty()) {
    options.machine.correction =
        std::make_shared<planner::CorrectionTable>(planner::CorrectionTable::read(options.correction));
  }
  options.job.power = planner::powerModelOf(options.power);
  if (commands.order->parsed()) {
    if (isGcode(options.input))
      throw planner::PlanError(options.input + ": an order is chosen for a drawing");
    base::toTerminal(stdout, planner::orderTable(chosenOf(options), options.machine, options.job));
    return 0;
  }
  const std::string text = gcodeOf(options);
  if (commands.gcode->parsed()) {
    planner::writeOutput(options.output, text);
    return 0;
  }
  if (commands.power_loop->parsed()) {
    comparePowerLoops(options, text);
    return 0;
  }
  if (commands.preview->parsed()) {
    const std::string name = options.input.substr(options.input.find_last_of('/') + 1);
    planner::writeOutput(options.output, planner::previewHtml(name, text, options.machine, options.job));
    return 0;
  }
  if (!commands.program->parsed()) return check(options, text);
  if (options.own_job.target == planner::OwnJobOptions::Target::kMcs51) {
    planner::writeOutput(options.output, planner::ownJobSource(options.own_job, options.input, text,
                                                               options.machine, options.job));
    return 0;
  }
  planner::writeOutput(options.output,
                       programText(planner::planFromGcode(text, options.machine, options.job).program));
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Plans the laser die-cutting of a dieline: order, G-code, motion, laser power, controller program.\n"
      "Exit codes: 0 it fits, 65 it does not or a file is wrong, 64 wrong command line, 2 the program "
      "broke.",
      "kerfplan"};
  app.set_version_flag("--version", base::version());
  app.require_subcommand(1);
  app.fallthrough();
  Options options;
  options.job.given_by = planner::GivenBy::kCommandLine;
  const Commands commands = addCommands(app, options);
  const planner::StripCommands strip(app, options.machine, options.job, [&](CLI::App& command) {
    addMachine(command, options);
    addJob(command, options.job);
  });
  const planner::CompensateCommand compensate(app);
  const planner::ProveCommand prove(app);
  const planner::PowerCommand power(app);
  const planner::LibraryCommand library(app);
  command_line::Dialogue dialogue(app, base::version());
  if (const auto told = dialogue.read(argc, argv)) return *told;
  if (compensate.run() || prove.run() || power.run() || library.run()) return 0;
  try {
    return run(commands, strip, options);
  } catch (const planner::PlanError& error) {
    throw planner::PlanError(withFile(options, error.what()));
  }
} catch (const planner::PlanError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const planner::PowerError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const dieline::DielineError& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const std::system_error& error) {
  base::toTerminal(stderr, fmt::format("{}\n", error.what()));
  return kBadInput;
} catch (const std::exception& error) {
  base::toTerminal(stderr, fmt::format("kerfplan: {}\n", error.what()));
  return kBroken;
}
