// SPDX-License-Identifier: Apache-2.0
#include "hil/app/machine_pictures.h"

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/scene/picture.h"

namespace kerfbench::hil {
namespace {

PictureOptions reportSize() {
  PictureOptions options;
  options.width_px = 640;
  options.height_px = 400;
  return options;
}

ReportPicture written(const std::filesystem::path& folder, const std::string& name,
                      const std::string& caption, const std::vector<std::uint8_t>& png) {
  ReportPicture picture{name, caption, std::string(png.begin(), png.end())};
  writeFileAtomically(folder / name, picture.png);
  return picture;
}

}  // namespace

Eigen::AlignedBox2d unitOf(const Dieline& dieline) { return dieline.bounds(); }

std::vector<ReportPicture> writeMachinePictures(const MachineFilm& film, const Case& the_case,
                                                const twin::MachineDescription& machine,
                                                const std::filesystem::path& folder, std::string& trouble) {
  std::vector<ReportPicture> pictures;
  trouble.clear();
  if (film.empty()) return pictures;
  if (!povrayFound()) {
    trouble = "no pictures of the machine: POV-Ray is not installed (apt-get install povray)";
    return pictures;
  }
  const twin::WebDescription web = webOf(the_case);
  const Eigen::AlignedBox2d unit = unitOf(the_case.dieline);
  try {
    PictureOptions options = reportSize();
    const double middle_s = film.middleOfLongestCut_s();
    pictures.push_back(written(folder, "machine.png",
                               fmt::format("The machine at {:.4f} s, in its longest cut", middle_s),
                               renderPng(film.sceneAt(middle_s, machine, web, unit), options)));
    options.view = SceneView::kSheet;
    options.caption = machine.name + "  the board in the end";
    pictures.push_back(written(folder, "board.png", "The board in the end, laid back under the head",
                               renderPng(film.finishedSheet(machine, web, unit), options)));
  } catch (const PictureError& e) {
    trouble = fmt::format("no picture of the machine: {}", e.what());
  }
  return pictures;
}

}  // namespace kerfbench::hil
