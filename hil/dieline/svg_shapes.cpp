// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "hil/dieline/geometry.h"
#include "hil/dieline/svg_css.h"
#include "hil/dieline/svg_page.h"
#include "hil/dieline/svg_path.h"
#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

class ShapeReader {
 public:
  ShapeReader(const pugi::xml_node& node, const SvgUnits& units)
      : node_(node), units_(units), closing_tolerance_(units.closing_tolerance) {}

  SvgShape read() {
    const std::string_view name = svgName(node_);
    if (name == "path") {
      path();
    } else if (name == "rect") {
      rect();
    } else if (name == "circle" || name == "ellipse") {
      round(name == "circle");
    } else if (name == "line") {
      emit(LineCurve{{length("x1"), length("y1")}, {length("x2"), length("y2")}});
    } else {
      points(name == "polygon");
    }
    if (!shape_.faults.empty()) shape_.curves.clear();
    return std::move(shape_);
  }

 private:
  [[nodiscard]] std::optional<double> optionalLength(const char* name) {
    // Percentages of a radius are of the mean of the sides (SVG 1.1, 7.10).
    const std::string_view which = name;
    const Eigen::Vector2d& port = units_.viewport;
    const double whole = which == "r" ? std::sqrt(port.squaredNorm() / 2)
                         : which.find('y') != std::string_view::npos || which == "height" ? port.y()
                                                                                          : port.x();
    std::string fault;
    const auto value = svgLengthOf(node_, name, units_.px_per_inch, whole, fault);
    if (!fault.empty()) shape_.faults.push_back(fault);
    return value;
  }
  double length(const char* name) { return optionalLength(name).value_or(0.0); }

  void emit(Curve curve, std::string part = {}) {
    shape_.curves.push_back(std::move(curve));
    shape_.parts.push_back(std::move(part));
  }

  void path() {
    SvgPath path = readSvgPath(node_.attribute("d").value(), closing_tolerance_);
    if (!path.fault.empty()) shape_.faults.push_back(path.fault);
    for (SvgPathCurve& c : path.curves) emit(std::move(c.curve), fmt::format("command {}", c.command));
  }

  void rect() {
    const double x = length("x");
    const double y = length("y");
    const double w = length("width");
    const double h = length("height");
    if (w < 0 || h < 0) shape_.faults.emplace_back("a negative width or height");
    if (!(w > 0) || !(h > 0)) return;  // The standard draws nothing.
    const auto rx_given = optionalLength("rx");
    const auto ry_given = optionalLength("ry");
    const double rx = std::clamp(rx_given.value_or(ry_given.value_or(0.0)), 0.0, w / 2);
    const double ry = std::clamp(ry_given.value_or(rx_given.value_or(0.0)), 0.0, h / 2);
    const bool is_round = rx > 0 && ry > 0;
    const double ax = is_round ? rx : 0.0;
    const double ay = is_round ? ry : 0.0;
    // Clockwise on the screen from the top left, as the standard orders it.
    const std::array<Vector2d, 8> p{{{x + ax, y},
                                     {x + w - ax, y},
                                     {x + w, y + ay},
                                     {x + w, y + h - ay},
                                     {x + w - ax, y + h},
                                     {x + ax, y + h},
                                     {x, y + h - ay},
                                     {x, y + ay}}};
    for (std::size_t side = 0; side < 4; ++side) {
      const Vector2d& from = p[2 * side];
      const Vector2d& to = p[2 * side + 1];
      if ((to - from).norm() > closing_tolerance_)
        emit(LineCurve{from, to}, fmt::format("side {}", side + 1));
      if (is_round)
        emit(svgArc(to, {rx, ry, 0.0, false, true}, p[(2 * side + 2) % 8]),
             fmt::format("corner {}", side + 1));
    }
  }

  void round(bool is_circle) {
    const Vector2d centre(length("cx"), length("cy"));
    const auto rx_given = optionalLength(is_circle ? "r" : "rx");
    const auto ry_given = is_circle ? rx_given : optionalLength("ry");
    const double rx = rx_given.value_or(ry_given.value_or(0.0));
    const double ry = ry_given.value_or(rx);
    if (rx < 0 || ry < 0) shape_.faults.emplace_back("a negative radius");
    if (!(rx > 0) || !(ry > 0)) return;
    if (rx == ry) {
      emit(ArcCurve{centre, rx, 0.0, 2 * pi});
    } else {
      emit(EllipseCurve{centre, {rx, 0.0}, {0.0, ry}, 0.0, 2 * pi});
    }
  }

  void points(bool closed) {
    SvgScanner scanner(node_.attribute("points").value());
    std::vector<Vector2d> list;
    while (!scanner.atEnd()) {
      const auto x = scanner.number();
      const auto y = x ? scanner.number() : std::nullopt;
      if (!y) {
        shape_.faults.push_back(fmt::format("points are broken at character {}", scanner.position() + 1));
        return;
      }
      list.emplace_back(*x, *y);
    }
    for (std::size_t i = 0; i + 1 < list.size(); ++i)
      emit(LineCurve{list[i], list[i + 1]}, fmt::format("segment {}", i + 1));
    if (closed && list.size() > 1 && (list.back() - list.front()).norm() > closing_tolerance_) {
      emit(LineCurve{list.back(), list.front()}, fmt::format("segment {}", list.size()));
    }
  }

  pugi::xml_node node_;
  SvgUnits units_;
  double closing_tolerance_;
  SvgShape shape_;
};

}  // namespace

bool isSvgShape(std::string_view element) {
  constexpr std::array<std::string_view, 7> kShapes{"path", "rect",     "circle", "ellipse",
                                                    "line", "polyline", "polygon"};
  return std::find(kShapes.begin(), kShapes.end(), element) != kShapes.end();
}

SvgShape readSvgShape(const pugi::xml_node& node, const SvgUnits& units) {
  return ShapeReader(node, units).read();
}

}  // namespace kerfbench::dieline
