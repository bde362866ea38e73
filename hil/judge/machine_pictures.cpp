// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/machine_pictures.h"

#include <fmt/format.h>

#include <cstdint>
#include <exception>

#include "hil/base/atomic_file.h"
#include "hil/dieline/geometry.h"
#include "hil/scene/picture.h"

namespace kerfbench::judge {
namespace {

scene::PictureOptions reportSize() {
  scene::PictureOptions options;
  options.width_px = 640;
  options.height_px = 400;
  options.quality = scene::PictureQuality::kDrawn;
  return options;
}

}  // namespace

Eigen::AlignedBox2d unitOf(const dieline::Dieline& dieline) { return dieline.bounds(); }

std::vector<report::ReportPicture> writeMachinePictures(const run::MachineFilm& film,
                                                        const scenario::Case& test_case,
                                                        const twin::MachineDescription& machine,
                                                        const std::filesystem::path& folder,
                                                        std::string& trouble, const Renderer& render) {
  std::vector<report::ReportPicture> pictures;
  trouble.clear();
  if (film.empty()) return pictures;
  const auto add = [&](const std::string& name, const std::string& caption, const twin::Scene& scene,
                       const scene::PictureOptions& options) {
    const std::vector<std::uint8_t> png = render(scene, options);
    pictures.push_back({name, caption, std::string(png.begin(), png.end())});
  };
  try {
    const twin::WebDescription web = scenario::webOf(test_case);
    const Eigen::AlignedBox2d unit = unitOf(*test_case.dieline);
    scene::PictureOptions options = reportSize();
    const double middle_s = film.middleOfLongestCut_s();
    add("machine.png", fmt::format("The machine at {:.4f} s, in its longest cut", middle_s),
        film.sceneAt(middle_s, machine, web, unit), options);
    options.view = scene::SceneView::kSheet;
    options.caption = machine.name + "  the board in the end";
    add("board.png", "The board in the end, laid back under the head", film.finishedSheet(machine, web, unit),
        options);
  } catch (const std::exception& e) {
    trouble = fmt::format("no picture of the machine: {}", e.what());
  }
  for (const report::ReportPicture& picture : pictures)
    base::writeFileAtomically(folder / picture.file, picture.png);
  return pictures;
}

}  // namespace kerfbench::judge
