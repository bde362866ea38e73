// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "hil/app/cli.h"
#include "hil/app/desk_command.h"

namespace kerfbench::app {
namespace {

void addPlan(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<PlanOptions>();
  options->bin_dir = program.bin_dir;
  CLI::App* plan = app.add_subcommand(
      "plan",
      "Plan the job of a scenario as run does, on its machine and for its release: whether it fits, and "
      "with\n"
      "what time. Its G-code and a page that plays the program's own steps can be written. Nothing is run.");
  plan->add_option("SCENARIO", options->scenario, "Scenario file; - is standard input")->required();
  plan->add_option("--with", options->gcode,
                   "G-code of one unit, planned in place of the scenario's own; - is standard input");
  plan->add_option("--gcode", options->gcode_out, "File for the G-code of one unit");
  plan->add_option("--preview", options->preview_out, "File for the page that plays the program (.html)");
  plan->add_option("--program", options->program_out,
                   "File for the controller's program, an operation per line in hex, as of kerfplan program");
  plan->add_flag("--json", options->as_json, "The plan with every period, as a line of JSON");
  actions.add(plan, [=] { return planCommand(*options); });
}

void addNew(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  const auto options = std::make_shared<NewOptions>();
  options->bin_dir = program.bin_dir;
  CLI::App* command = app.add_subcommand(
      "new",
      "Write a first scenario for a drawing: on a resting sheet, with layers by their usual names, "
      "registration\n"
      "marks round the drawing, speeds that the machine has, and a word on all that one may want to change.");
  command->add_option("DRAWING", options->drawing, "The drawing (.dxf, .svg, .cf2, .pdf)")->required();
  command->add_option("--machine", options->machine, "Machine file (fixtures/machines/*.yaml)")->required();
  command->add_option("--out,-o", options->out, "Scenario file, not there yet")->required();
  actions.add(command, [=] { return newCommand(*options); });
}

void addEdit(CLI::App& app, cli::CliActions& actions) {
  const auto options = std::make_shared<EditOptions>();
  CLI::App* edit = app.add_subcommand(
      "edit",
      "Set and remove keys of a scenario or a machine file; comments, order and all else stay as they are");
  edit->add_option("SCENARIO", options->scenario, "Scenario or machine file")->required();
  edit->add_option("--set", options->set,
                   "KEY=VALUE, as belt.speed_mm_s=60 or 'planner.order=[3, 0, 5-8]'; may be given often");
  edit->add_option("--remove", options->remove, "KEY, so that what the file extends or the default holds");
  edit->final_callback([=] {
    if (options->set.empty() && options->remove.empty()) throw CLI::RequiredError("--set or --remove");
  });
  actions.add(edit, [=] { return editCommand(*options); });
}

}  // namespace

void addDesk(CLI::App& app, const cli::CliProgram& program, cli::CliActions& actions) {
  addNew(app, program, actions);
  addEdit(app, actions);
  addPlan(app, program, actions);
}

}  // namespace kerfbench::app
