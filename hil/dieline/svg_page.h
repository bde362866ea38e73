// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "hil/dieline/faults.h"
#include "hil/dieline/read.h"
#include "hil/dieline/svg_style.h"

namespace pugi {
class xml_node;
}  // namespace pugi

namespace kerfbench::dieline {

/// Size of the page, and what a user unit is.
struct SvgPage {
  double px_per_inch{96.0};  ///< 96 in CSS, 72 of Illustrator, 90 of Inkscape up to 0.91.
  Eigen::Affine2d X{Eigen::Affine2d::Identity()};  ///< User units -> mm in S; the page's bottom left is 0, 0.
  Eigen::Vector2d size{Eigen::Vector2d::Zero()};   ///< Size of the page in user units: what 100 % is.
  bool says_unit{true};  ///< The file says how long a unit is, or which program wrote it.
};

/// A length attribute in user units. Percentages are of `whole`; nothing where it is missing or "auto".
std::optional<double> svgLengthOf(const pugi::xml_node& node, const char* name, double px_per_inch,
                                  double whole, std::string& fault);

/// viewBox with width and height, of which one may follow from the other. Returns nothing and a fault where
/// they are broken.
std::optional<SvgViewport> svgViewport(const pugi::xml_node& node, std::optional<double> width,
                                       std::optional<double> height, std::string& fault);

/// The page by the unit that is told, else by its size in mm, cm, in, pt or pc, else by the program that
/// wrote it. A file that gives its size in px only and does not say who wrote it is a fault: 72, 90 and 96 px
/// per inch are all usual. `prolog`: the text before the outermost element. `line`: of that element.
SvgPage svgPage(const pugi::xml_node& root, std::string_view prolog, const DrawingOptions& options, int line,
                FaultList& faults);

}  // namespace kerfbench::dieline
