// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::head_service {

/// A page to print true to scale: black on white, all lengths in mm. The origin is the page's lower left
/// corner, x to the right, y upwards.
struct PrintPage {
  struct Disc {
    Eigen::Vector2d p_mm;
    double radius_mm{};
  };
  struct Line {
    Eigen::Vector2d from_mm, to_mm;
    double width_mm{0.25};
  };
  enum class Anchor { kLeft, kMiddle, kRight };
  struct Text {
    Eigen::Vector2d p_mm;  ///< On the base line, at the anchor.
    double height_mm{};    ///< Size of the type; > 0.
    std::string text;
    Anchor anchor{Anchor::kLeft};
  };
  using Shape = std::variant<Disc, Line, Text>;

  Eigen::Vector2d size_mm{Eigen::Vector2d::Zero()};
  std::vector<Shape> shapes;

  /// A line with two barbs at its end.
  void arrow(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);
};

/// SVG 1.1 whose width and height are the page's in mm.
std::string svgOf(const PrintPage& page);
/// PDF 1.4 of one page, 72/25.4 points a millimetre, type Helvetica. Characters beyond Latin-1 become "?".
std::string pdfOf(const PrintPage& page);

}  // namespace kerfbench::head_service
