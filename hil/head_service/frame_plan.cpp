// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "hil/base/yaml_reader.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr double kLaid_mm = 2.0;       // How far a sheet may lie from where it is supposed.
constexpr double kOverlapSizes = 0.6;  // Sizes of a mark: its arms are whole in one picture each.

/// All that a picture must show: print, and field marks wherever the head may have put them.
Eigen::AlignedBox2d sheetOf(const calibrate::MarkJob& job) {
  Eigen::AlignedBox2d box;
  for (const RegistrationMark& mark : job.print) {
    box.extend(mark.p_SM_mm - Vector2d::Constant(mark.diameter_mm));
    box.extend(mark.p_SM_mm + Vector2d::Constant(mark.diameter_mm));
  }
  for (const calibrate::WantedMark& mark : job.marks) {
    box.extend(job.wanted_S_mm(mark) - Vector2d::Constant(job.size_mm));
    box.extend(job.wanted_S_mm(mark) + Vector2d::Constant(job.size_mm));
  }
  return {box.min() - Vector2d::Constant(kLaid_mm), box.max() + Vector2d::Constant(kLaid_mm)};
}

/// Middles of as many views of `view_mm` as cover `side_mm` with this overlap, evenly, from -side/2 on.
std::vector<double> middlesOf(double side_mm, double view_mm, double overlap_mm) {
  const double step_mm = view_mm - overlap_mm;
  const int count = std::max(1, static_cast<int>(std::ceil((side_mm - overlap_mm) / step_mm)));
  std::vector<double> middles;
  const double first_mm = count == 1 ? 0.0 : 0.5 * (view_mm - side_mm);
  for (int k = 0; k < count; ++k)
    middles.push_back(count == 1 ? 0.0 : first_mm - 2.0 * first_mm * k / (count - 1));
  return middles;
}

}  // namespace

std::vector<ExpectedFrame> expectedFrames(const calibrate::MarkJob& job,
                                          const vision::CameraCalibration& camera) {
  const Eigen::AlignedBox2d sheet = sheetOf(job);
  const Vector2d view = camera.area_mm.sizes();
  const double overlap_mm = std::min(kOverlapSizes * job.size_mm, 0.5 * view.minCoeff());
  const std::vector<double> xs = middlesOf(sheet.sizes().x(), view.x(), overlap_mm);
  std::vector<double> ys = middlesOf(sheet.sizes().y(), view.y(), overlap_mm);
  std::vector<ExpectedFrame> frames;
  for (std::size_t row = 0; row < ys.size(); ++row) {
    for (std::size_t column = 0; column < xs.size(); ++column) {
      const std::size_t k = row % 2 == 0 ? column : xs.size() - 1 - column;
      const Vector2d middle = sheet.center() + Vector2d(xs[k], ys[row]);
      // In micrometres, as somebody may set a table.
      const Vector2d p_TV = ((middle - camera.area_mm.center()) * 1e3).array().round() / 1e3;
      frames.push_back({fmt::format("tile-{:04}.png", frames.size()),
                        p_TV,
                        {p_TV + camera.area_mm.min(), p_TV + camera.area_mm.max()}});
    }
  }
  return frames;
}

std::string tilesTemplate(const calibrate::MarkJob& job, const vision::CameraCalibration& camera,
                          const std::vector<ExpectedFrame>& frames) {
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Pictures of the sheet {0} of {1}: {2} of camera {3}, {4} x {5} pixels of {6:.5f} mm, PNG or JPEG "
      "(named .png),\n"
      "# against the back light, the printed marks included. Put them beside this file under these names and "
      "run the\n"
      "# command again; change nothing here if the camera stood where it is told below.\n"
      "#\n"
      "# Lay the sheet on the camera's table with its origin where the table reads (0, 0), axes parallel, "
      "within {7:g} mm;\n"
      "# its true place is found by its printed marks. p_TV_mm: reading of the table's scales for this "
      "picture, x and y,\n"
      "# mm. If it was another one, write that; it counts to a micrometre. Pictures may be left out or "
      "added, as long as\n"
      "# every mark is whole in one of them.\n"
      "version: 1\n"
      "tiles:\n",
      job.name, job.machine, frames.size(), camera.camera_id, camera.width_px, camera.height_px,
      camera.pitchMm(), kLaid_mm);
  for (const ExpectedFrame& frame : frames) {
    text += fmt::format(
        "  - {{file: {}, p_TV_mm: [{:.3f}, {:.3f}]}}   # Shows x {:.1f} … {:.1f}, y {:.1f} … {:.1f} mm of "
        "the sheet.\n",
        frame.file, frame.p_TV_mm.x() + 0.0, frame.p_TV_mm.y() + 0.0, frame.shows_mm.min().x(),
        frame.shows_mm.max().x(), frame.shows_mm.min().y(), frame.shows_mm.max().y());
  }
  return text;
}

FolderOfFrames framesIn(const fs::path& folder) {
  auto list = base::YamlReader::openFile(folder / "tiles.yaml");
  FolderOfFrames found;
  std::set<std::string> named;
  for (base::YamlReader& tile : list.list("tiles")) {
    const std::string file = tile.text("file", "");
    if (!named.insert(file).second) continue;
    std::error_code ignored;
    if (!fs::is_regular_file(folder / file, ignored)) found.missing.push_back(file);
  }
  found.named = named.size();
  for (const std::string& name : picturesIn(folder))
    if (!named.contains(name)) found.unnamed.push_back(name);
  return found;
}

std::vector<std::string> picturesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    const bool picture = ending == ".png" || ending == ".jpg" || ending == ".jpeg";
    if (entry.is_regular_file() && picture) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace kerfbench::head_service
