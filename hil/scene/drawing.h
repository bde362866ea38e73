// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/base/png_codec.h"
#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A scene drawn by a depth buffer: the same parts, lamps and colours as the ray-traced picture has, with
/// shadows from a map and mirrors that see lamps and floor alone, in a tenth of the time and without another
/// program. Red, green and blue, 8 bits. The same picture every time.
base::PngSamples drawScene(const twin::Scene& scene, const Viewpoint& view);

}  // namespace kerfbench::scene
