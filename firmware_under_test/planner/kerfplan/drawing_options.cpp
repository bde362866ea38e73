// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/drawing_options.h"

namespace kerfbench::planner {

void addDrawingOptions(CLI::App& app, dieline::DrawingArguments& arguments) {
  const std::string group = "How a drawing is read";
  app.add_option("--unit", arguments.unit, "What a unit of the drawing is: mm, cm, in, pt or px (1/96 in)")
      ->group(group);
  app.add_option("--page", arguments.page, "Page of a PDF that has several")
      ->check(CLI::Range(1, 9999))
      ->group(group);
  app.add_option("--scale", arguments.scale, "Enlarge the drawing so many times")
      ->capture_default_str()
      ->group(group);
  app.add_option("--turn", arguments.turn_deg, "Turn it about the origin, degrees counter-clockwise")
      ->capture_default_str()
      ->group(group);
  app.add_option("--shift", arguments.shift_mm, "Move it by x and y, mm")->expected(2)->group(group);
  app.add_flag("--once", arguments.once, "Leave out lines that lie wholly on another of their process")
      ->group(group);
  app.add_option("--layer", arguments.layers,
                 "What a layer is for, in place of the usual names: CUT=cut, '*/color/1=cut', "
                 "'*/linetype/DASHED=perforation', '*/other=ignore'; may be given often")
      ->group(group);
}

}  // namespace kerfbench::planner
