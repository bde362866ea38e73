// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace kerfbench::drawing {

/// What a picture of a drawing shows beside its lines.
struct PictureContent {
  std::string title;  ///< First line of the picture, e.g. the file's name.
  std::vector<dieline::LintFinding> findings;
  std::vector<std::string> notes;  ///< Lines below the picture, e.g. what was ignored and why.
  int width_px{1200};              ///< 400 … 8192.
};

/// What lint finds in a drawing, the worst twenty of each kind, and what its reader noted. Errors that are
/// accepted become warnings.
PictureContent contentOf(const dieline::Dieline& dieline, std::string title, int width_px,
                         const std::set<dieline::LintFinding::Kind>& accepted,
                         const base::ProgressFn& progress = {});

/// A drawing in the sheet's frame S (x to the right, y up) with a scale in mm at two sides and the origin
/// where it lies within: lines in the colour of their process, pieces shaded, holes and what lies outside
/// left white, what no process takes in thin grey; a row for each process and layer with the number of its
/// lines and their length; the faults that lint found as numbered marks, the errors first, with a line for
/// each of the first twenty and the number of the others. One SVG file, nothing loaded from elsewhere.
/// @throws std::invalid_argument where the width is out of range, or nothing finite is drawn.
std::string svgOf(const dieline::Dieline& dieline, const PictureContent& content);
/// The same picture as a PNG file's bytes. Letters beyond ASCII become '?'.
std::vector<std::uint8_t> pngOf(const dieline::Dieline& dieline, const PictureContent& content);

}  // namespace kerfbench::drawing
