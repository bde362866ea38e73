// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Settings, materials and the rounded box, in POV-Ray's language.
extern const char* const kPovMaterials;

/// Name of a material in POV-Ray.
const char* materialName(twin::Material material);

}  // namespace kerfbench::scene
