// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// The scene as seen from a place, in POV-Ray's language (3.7, no include files). Lengths in mm. Lines that
/// would be finer than a pixel (beam, burnt paths) are drawn about a pixel wide.
std::string povText(const twin::Scene& scene, const Viewpoint& view);

}  // namespace kerfbench::scene
