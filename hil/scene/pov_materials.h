// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Settings, materials and the rounded box, in POV-Ray's language.
extern const char* const kPovMaterials;

/// What a material is called there.
const char* materialName(twin::Material material);

}  // namespace kerfbench::scene
