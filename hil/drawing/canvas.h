// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a picture of a drawing is made on. Private to hil/drawing. Places are in pixels from the upper left
// corner.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::drawing {

using Polyline = std::vector<Eigen::Vector2d>;

/// Red, green, blue, 0 … 255 each, as 0xrrggbb.
using Colour = std::uint32_t;

enum class Anchor { kStart, kMiddle, kEnd };

struct Pen {
  Colour colour{};
  double width_px{1.0};
  double dash_px{};  ///< Length of dashes and of the gaps between them; 0: none.
};

class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void strokes(const std::vector<Polyline>& lines, const Pen& pen) = 0;
  /// Fills what lies within an odd number of the polygons.
  virtual void fill(const std::vector<Polyline>& polygons, Colour colour) = 0;
  virtual void disc(const Eigen::Vector2d& centre, double radius_px, Colour colour) = 0;
  /// `at` is the start, middle or end of the text's base line.
  virtual void text(const Eigen::Vector2d& at, const std::string& text, double height_px, Colour colour,
                    Anchor anchor) = 0;
  /// Bytes of the file.
  [[nodiscard]] virtual std::string finished() = 0;
};

std::unique_ptr<Canvas> svgCanvas(int width_px, int height_px);
std::unique_ptr<Canvas> pngCanvas(int width_px, int height_px);

}  // namespace kerfbench::drawing
