// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// Largest distance of a drawn line from its curve.
inline constexpr double kDrawnWithin_mm = 0.01;

/// Points along a curve, both ends included, whose chords leave it by kDrawnWithin_mm at most.
std::vector<Eigen::Vector2d> polylineOf(const dieline::Curve& curve);

/// The line of the file in which an entity begins; 0: none is known.
int lineOfOrigin(const std::string& origin);

/// The drawing of an answer (scenario_check.h) without its file: `entities`, `findings`, `layers`, `notes`,
/// `svg`, `size_mm`, `min_mm`, `shown`, `count`.
nlohmann::json drawingJson(const dieline::Dieline& drawing, const dieline::LintReport& lint,
                           const std::set<dieline::LintFinding::Kind>& accepted);

}  // namespace kerfbench::desk
