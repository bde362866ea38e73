// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hil/report/run_report.h"
#include "hil/run/machine_film.h"
#include "hil/scenario/case.h"
#include "hil/scene/picture.h"

namespace kerfbench::judge {

/// Makes a PNG file's bytes of a scene; see scene::renderPng().
using Renderer = std::function<std::vector<std::uint8_t>(const twin::Scene&, const scene::PictureOptions&)>;

/// Two pictures of a run for its report, 640 x 400, drawn in a fraction of a second: machine.png, in the
/// middle of the longest cut, and board.png, the finished board. `machine`: the one that ran. Without
/// anything filmed, or when a picture fails: what could be made, and why not the rest in `trouble` (a
/// sentence, or empty). A picture is an ornament: it neither changes nor stops a verdict.
/// @throws std::system_error if `folder` cannot be written.
std::vector<report::ReportPicture> writeMachinePictures(
    const run::MachineFilm& film, const scenario::Case& test_case, const twin::MachineDescription& machine,
    const std::filesystem::path& folder, std::string& trouble, const Renderer& render = scene::renderPng);

/// What a unit of the job covers, in its S.
Eigen::AlignedBox2d unitOf(const dieline::Dieline& dieline);

}  // namespace kerfbench::judge
