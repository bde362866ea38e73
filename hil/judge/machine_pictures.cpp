// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/machine_pictures.h"

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/dieline/geometry.h"
#include "hil/scene/picture.h"

namespace kerfbench::judge {
namespace {

scene::PictureOptions reportSize() {
  scene::PictureOptions options;
  options.width_px = 640;
  options.height_px = 400;
  return options;
}

report::ReportPicture written(const std::filesystem::path& folder, const std::string& name,
                              const std::string& caption, const std::vector<std::uint8_t>& png) {
  report::ReportPicture picture{name, caption, std::string(png.begin(), png.end())};
  base::writeFileAtomically(folder / name, picture.png);
  return picture;
}

}  // namespace

Eigen::AlignedBox2d unitOf(const dieline::Dieline& dieline) { return dieline.bounds(); }

std::vector<report::ReportPicture> writeMachinePictures(const run::MachineFilm& film,
                                                        const scenario::Case& test_case,
                                                        const twin::MachineDescription& machine,
                                                        const std::filesystem::path& folder,
                                                        std::string& trouble) {
  std::vector<report::ReportPicture> pictures;
  trouble.clear();
  if (film.empty()) return pictures;
  if (!scene::povrayFound()) {
    trouble = "no pictures of the machine: POV-Ray is not installed (apt-get install povray)";
    return pictures;
  }
  const twin::WebDescription web = scenario::webOf(test_case);
  const Eigen::AlignedBox2d unit = unitOf(*test_case.dieline);
  try {
    scene::PictureOptions options = reportSize();
    const double middle_s = film.middleOfLongestCut_s();
    pictures.push_back(written(folder, "machine.png",
                               fmt::format("The machine at {:.4f} s, in its longest cut", middle_s),
                               scene::renderPng(film.sceneAt(middle_s, machine, web, unit), options)));
    options.view = scene::SceneView::kSheet;
    options.caption = machine.name + "  the board in the end";
    pictures.push_back(written(folder, "board.png", "The board in the end, laid back under the head",
                               scene::renderPng(film.finishedSheet(machine, web, unit), options)));
  } catch (const scene::PictureError& e) {
    trouble = fmt::format("no picture of the machine: {}", e.what());
  }
  return pictures;
}

}  // namespace kerfbench::judge
