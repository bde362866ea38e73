// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/scene/raster.h"
#include "hil/scene/shading.h"
#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A straight line or a dot with a width in pixels, drawn over the parts that lie behind it.
struct Stroke {
  enum class Kind {
    kBurnt,    ///< A cut: opaque.
    kBeamOff,  ///< The path that the beam would take.
    kCore,     ///< The lit beam: opaque in the middle.
    kGlow,     ///< What shines around the lit beam.
    kSpot,     ///< Where the beam burns: an opaque dot.
  };
  Kind kind{};
  Eigen::Vector2d from_px, to_px;
  Eigen::Vector2d half_px;   ///< Half of its width at both ends.
  Eigen::Vector2d nearness;  ///< One over the depth at both ends, 1/mm.
  double relief{};           ///< Share of its depth by which it may lie behind a part and still be seen.
};

/// Cuts of a scene, and its beam with the spot, each in the order in which they are drawn.
std::vector<Stroke> burntStrokes(const twin::Scene& scene, const Viewpoint& view);
std::vector<Stroke> beamStrokes(const twin::Scene& scene, const Viewpoint& view);

/// A stroke at the middle of a pixel.
struct StrokeSample {
  double cover{};  ///< Share of what is behind that it hides, 0 … 1.
  double nearness{};
};
std::optional<StrokeSample> sampleOf(const Stroke& stroke, const Eigen::Vector2d& p_px);
Colour colourOf(Stroke::Kind kind);

}  // namespace kerfbench::scene
