// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/scene/povray.h"
#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Part of the machine that a picture shows.
enum class SceneView {
  kOverall,  ///< All of it.
  kHead,     ///< Mirrors and motors of the head, or the carriage of a gantry.
  kSheet,    ///< The board from above, without what hangs over it.
};

enum class PictureQuality {
  kTraced,  ///< Ray-traced by POV-Ray, in seconds.
  kDrawn,   ///< See drawScene(): a quarter of a second, with coarser shadows and reflections.
};

struct PictureOptions {
  PictureQuality quality{PictureQuality::kTraced};
  SceneView view{SceneView::kOverall};
  int width_px{1280};                      ///< 64 … 8192
  int height_px{800};                      ///< 64 … 8192
  bool inset{true};                        ///< The head, small, in a corner of kOverall.
  std::string caption;                     ///< Along the lower edge; ASCII. Empty: machine and time.
  std::filesystem::path povray{"povray"};  ///< For kTraced.
};

/// Viewpoint of a picture. `inset`: kOverall leaves room for it.
Viewpoint viewpointOf(const twin::Scene& scene, SceneView view, int width_px, int height_px,
                      bool inset = false);

/// A picture as a PNG file's bytes: the same for the same scene and options, whatever the host's settings
/// (one version of POV-Ray and OpenCV assumed).
/// @throws PictureError for a size out of range; for kTraced also without POV-Ray, or when it fails.
std::vector<std::uint8_t> renderPng(const twin::Scene& scene, const PictureOptions& options);

}  // namespace kerfbench::scene
