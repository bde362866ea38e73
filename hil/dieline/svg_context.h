// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/dieline/svg_clip.h"
#include "hil/dieline/svg_css.h"

namespace pugi {
class xml_node;
}  // namespace pugi

namespace kerfbench::dieline {

/// What children inherit.
struct SvgContext {
  Eigen::Affine2d X{Eigen::Affine2d::Identity()};     ///< User units here -> mm in S.
  Eigen::Vector2d viewport{Eigen::Vector2d::Zero()};  ///< What 100 % is, user units.
  std::string colour{"#000000"};                      ///< For a stroke of "currentColor".
  std::string stroke{"none"};  ///< #rrggbb, "none", or "?" and the value where it is no plain colour.
  bool is_visible{true};
  bool is_displayed{true};  ///< False: nothing below is.
  bool has_width{true};     ///< The stroke's width is not 0.
  bool is_dashed{};
  bool is_opaque_stroke{true};  ///< The stroke-opacity is not 0.
  bool is_faded{};              ///< An opacity of 0 here or above.
  bool overflows{};             ///< What is outside of the viewport is drawn; not inherited.
  std::string clip_path;        ///< Reference such as "url(#a)"; not inherited.
  std::string faults;           ///< What is wrong with the properties; not inherited.
  std::vector<ClipRegion> clips;
  std::vector<std::string> layers;  ///< Labels of the enclosing Inkscape layers, outermost first.
  int depth{};
};

/// The context inside of an element with these values of properties.
SvgContext svgInside(SvgContext outer, const SvgStyle& style);

/// True when the conditions of an element hold (SVG 1.1, 5.8): no extension is known, and the language is
/// English.
bool svgConditionsHold(const pugi::xml_node& node);

}  // namespace kerfbench::dieline
