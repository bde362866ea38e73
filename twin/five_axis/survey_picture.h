// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "twin/base/image_fwd.h"
#include "twin/camera/camera.h"
#include "twin/five_axis/folded_blank.h"

namespace kerfbench::twin {

/// Picture of a blank as it stands, by a camera at its side. Each face is plain board with its printed marks,
/// as a SpotCamera shows a plane; of faces behind each other the nearest is seen; beside them it is dark.
/// What is burnt is not drawn. `camera.X_CP` is the pose of W in the camera; the lens has no distortion (its
/// pictures are straightened) and is no telecentric one. Noise is sampled from `seed`.
/// @throws std::invalid_argument for a camera that is out of range or has such a lens.
GrayImage surveyPicture(const CameraDescription& camera, const std::vector<BlankFace>& faces,
                        std::uint64_t seed);

}  // namespace kerfbench::twin
