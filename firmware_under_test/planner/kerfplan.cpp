// SPDX-License-Identifier: Apache-2.0
// kerfplan: the host half of the reference controller as a program of its own.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/kerf.h"
#include "firmware_under_test/planner/kerfplan_compensate.h"
#include "firmware_under_test/planner/plan.h"
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
  const std::string tail = path.substr(std::min(path.size(), path.find_last_of('.')));
  return std::set<std::string>{".nc", ".ngc", ".gcode", ".tap", ".txt"}.count(CLI::detail::to_lower(tail)) >
         0;
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw planner::PlanError(path + ": cannot be opened");
  return {std::istreambuf_iterator<char>(file), {}};
}

hil::Dieline readInput(const Options& options) {
  hil::Dieline dieline = hil::readDieline(options.input, hil::defaultLayerProfile());
  if (dieline.entities.empty()) throw planner::PlanError(options.input + ": no entities");
  return dieline;
}

std::string gcodeOf(const Options& options) {
  const bool compensates = options.job.kerf_radius_mm > 0.0;
  if (isGcode(options.input)) {
    if (compensates)
      throw planner::PlanError(options.input + ": G-code is the beam's path, --kerf-radius is for drawings");
    return readText(options.input);
  }
  const hil::Dieline dieline = readInput(options);
  std::string gcode = planner::makeGcode(dieline, options.machine, options.job);
  if (compensates) {
    for (const std::string& note : planner::compensate(dieline, options.job).notes) std::cerr << note << '\n';
  }
  return gcode;
}

void write(const Options& options, const std::string& text) {
  if (options.output.empty() || options.output == "-") {
    std::cout << text;
    return;
  }
  std::ofstream file(options.output, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error(options.output + ": cannot be written");
}

std::string hexOf(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// One line for the configuration, then one for each operation, in hexadecimal.
std::string programText(const planner::Program& program) {
  std::string text = "config " + hexOf(program.config) + "\n";
  for (const auto& op : program.ops) text += hexOf(op) + "\n";
  return text;
}

std::string summaryOf(const Options& options, const planner::Plan& plan) {
  std::size_t bytes = 0;
  for (const auto& op : plan.program.ops) bytes += op.size();
  return fmt::format(
      "{}: fits\n"
      "  belt            {:.2f} mm/s, at most {:.2f} mm/s\n"
      "  unit            {:.4f} s, with the way back {:.4f} s\n"
      "  marks / jumps   {:.3f} mm / {:.3f} mm\n"
      "  start           unit 0's origin at x = {:.3f} mm\n"
      "  program         {} operations, {} bytes\n",
      options.input, options.job.belt_speed_mm_s, plan.max_belt_speed_mm_s, plan.unit_time_s,
      plan.cycle_time_s, plan.cut_length_mm, plan.jump_length_mm, plan.x_ref_mm, plan.program.ops.size(),
      bytes);
}

void addMachine(CLI::App& app, MachineParameters& m) {
  const std::map<std::string, MachineParameters::Head> heads{
      {"two-mirror", MachineParameters::Head::kTwoMirror}, {"gantry", MachineParameters::Head::kGantry}};
  const std::string group = "Machine";
  const auto option = [&](const char* name, double& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  app.add_option("--head", m.head, "What moves the beam: two-mirror or gantry")
      ->transform(CLI::CheckedTransformer(heads, CLI::ignore_case))
      ->default_str("two-mirror")
      ->group(group);
  option("--throw", m.throw_mm, "Y mirror to sheet, mm (two-mirror)");
  option("--mirror-spacing", m.mirror_spacing_mm, "X mirror to Y mirror, mm (two-mirror)");
  option("--mirror-step", m.mirror_step_rad, "Mechanical angle of one step, rad (two-mirror)");
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
}

void addJob(CLI::App& app, JobParameters& j) {
  const std::string group = "Job";
  const auto option = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  option("--belt-speed", j.belt_speed_mm_s, "Speed of the sheet, mm/s; 0: it rests");
  option("--mark-speed", j.mark_speed_mm_s, "Highest speed of marks on the sheet, mm/s");
  option("--jump-speed", j.jump_speed_mm_s, "Highest speed of jumps and of the way back, mm/s");
  option("--acceleration", j.acceleration_mm_s2, "Highest acceleration, mm/s2");
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
  planner::addKerfOptions(app, j);
  app.add_flag("--alternate", j.alternate, "Cut every second unit backwards")->group(group);
  app.add_flag("--stop-and-go", j.stop_and_go,
               "With --feed: feed a pitch at the belt speed, stop, cut at rest")
      ->group(group);
  app.add_flag("--feed", j.feed_by_controller, "The controller drives the belt")->group(group);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Plans the laser die-cutting of a dieline: order, G-code, motion, laser power, controller program.\n"
      "Exit codes: 0 it fits, 65 it does not or a file is wrong, 64 wrong command line, 2 the program "
      "broke."};
  app.require_subcommand(1);
  Options options;
  const auto subcommand = [&](const char* name, const char* help, bool writes) {
    CLI::App* sub = app.add_subcommand(name, help);
    sub->add_option("DIELINE", options.input,
                    "A .dxf or .svg drawing, or G-code (.nc, .ngc, .gcode, .tap, .txt)")
        ->required();
    if (writes) sub->add_option("-o,--output", options.output, "File to write instead of standard output");
    addMachine(*sub, options.machine);
    addJob(*sub, options.job);
    return sub;
  };
  const CLI::App* gcode = subcommand("gcode", "Write the G-code of one unit, to read or to edit", true);
  const CLI::App* program = subcommand(
      "program", "Write the controller's program of all units, an operation per line in hex", true);
  subcommand("check", "Say whether and how the job fits the machine", false);
  const planner::CompensateCommand compensate(app);
  const planner::ProveCommand prove(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  if (compensate.run() || prove.run()) return 0;
  const std::string text = gcodeOf(options);
  if (gcode->parsed()) {
    write(options, text);
    return 0;
  }
  const planner::Plan plan = planner::planFromGcode(text, options.machine, options.job);
  if (program->parsed()) {
    write(options, programText(plan.program));
  } else {
    std::cout << summaryOf(options, plan);
  }
  return 0;
} catch (const planner::PlanError& error) {
  std::cerr << error.what() << '\n';
  return kBadInput;
} catch (const hil::DielineError& error) {
  std::cerr << error.what() << '\n';
  return kBadInput;
} catch (const std::system_error& error) {
  std::cerr << error.what() << '\n';
  return kBadInput;
} catch (const std::exception& error) {
  std::cerr << "kerfplan: " << error.what() << '\n';
  return kBroken;
}
