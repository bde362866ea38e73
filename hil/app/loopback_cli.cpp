// SPDX-License-Identifier: Apache-2.0
#include "hil/app/loopback_cli.h"

namespace kerfbench::app {

void addLoopbackOptions(CLI::App& doctor, doctor::LoopbackOptions& options) {
  CLI::Option* bench =
      doctor.add_flag("--bench", options.wanted,
                      "Measure on two lines that a jumper joins: drive edges on one, read them on "
                      "the other");
  CLI::Option* lines =
      doctor.add_option("--loop-back", options.loop_back,
                        "OUT=IN, numbers or names: the line that is driven and the one that reads it");
  bench->needs(lines)->excludes(doctor.get_option("SCENARIO"));
  lines->needs(bench);
  doctor.add_option("--chip", options.chip, "IN's chip: path, name or label; otherwise the only one")
      ->needs(bench);
  doctor.add_option("--out-chip", options.out_chip, "OUT's chip, if it is another")->needs(bench);
  doctor
      .add_option("--beside", options.beside,
                  "A line of IN's chip that is read besides, as in a run;\notherwise the first free input")
      ->needs(bench);
  doctor
      .add_option("--rates", options.rates_hz, "Edges in a second, one after the other until some are lost")
      ->delimiter(',')
      ->check(CLI::Range(10.0, 1e6))
      ->needs(bench);
  doctor.add_option("--seconds", options.seconds, "For each rate")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str()
      ->needs(bench);
}

}  // namespace kerfbench::app
