// SPDX-License-Identifier: Apache-2.0
// Pictures of the sheet that a scenario's release cuts on the twin, as files of a kerf camera (tiles.yaml):
//   kerfbench-photograph SCENARIO FOLDER
#include <exception>
#include <filesystem>

#include <fmt/format.h>

#include "hil/camera/tile_folder.h"
#include "hil/run/cut_on_twin.h"
#include "hil/scenario/case.h"

int main(int argc, char** argv) {
  using namespace kerfbench;
  if (argc != 3) {
    fmt::print(stderr, "usage: {} SCENARIO FOLDER\n", argv[0]);
    return 64;
  }
  try {
    const std::filesystem::path bin_dir = std::filesystem::canonical("/proc/self/exe").parent_path();
    scenario::Case test_case = scenario::readCase(argv[1], bin_dir.parent_path() / "firmware");
    test_case.scenario.fidelity = twin::Fidelity::kFast;
    run::CutSheet cut = run::cutOnTwin(test_case, bin_dir, [](double, const std::string&) {});
    camera::TwinTileSource tiles =
        run::kerfTiles(test_case, test_case.machine, cut.machine->sheet(), {.threads = 1});
    camera::writeTiles(tiles, argv[2]);
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}
