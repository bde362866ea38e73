// SPDX-License-Identifier: Apache-2.0
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/drawing/canvas.h"

namespace kerfbench::drawing {
namespace {

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(int width_px, int height_px)
      : svg_(fmt::format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' "
                         "height='{1}' font-family='sans-serif'>\n"
                         "<rect width='{0}' height='{1}' fill='#fff'/>\n",
                         width_px, height_px)) {}

  void strokes(const std::vector<Polyline>& lines, const Pen& pen) override {
    if (lines.empty()) return;
    fmt::format_to(std::back_inserter(svg_),
                   "<path fill='none' stroke='#{:06x}' stroke-width='{:g}' stroke-linecap='round' "
                   "stroke-linejoin='round'",
                   pen.colour, pen.width_px);
    if (pen.dash_px > 0.0)
      fmt::format_to(std::back_inserter(svg_), " stroke-dasharray='{0:g} {0:g}'", pen.dash_px);
    path(lines, "");
  }
  void fill(const std::vector<Polyline>& polygons, Colour colour) override {
    if (polygons.empty()) return;
    fmt::format_to(std::back_inserter(svg_), "<path fill='#{:06x}' fill-rule='evenodd'", colour);
    path(polygons, "z");
  }
  void disc(const Eigen::Vector2d& centre, double radius_px, Colour colour) override {
    fmt::format_to(std::back_inserter(svg_), "<circle cx='{}' cy='{}' r='{:g}' fill='#{:06x}'/>\n",
                   base::hundredths(centre.x()), base::hundredths(centre.y()), radius_px, colour);
  }
  void text(const Eigen::Vector2d& at, const std::string& text, double height_px, Colour colour,
            Anchor anchor) override {
    const char* name = anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
    fmt::format_to(std::back_inserter(svg_),
                   "<text x='{}' y='{}' font-size='{:g}' fill='#{:06x}' text-anchor='{}'>{}</text>\n",
                   base::hundredths(at.x()), base::hundredths(at.y()), height_px, colour, name,
                   base::escapeHtml(text));
  }
  std::string finished() override { return std::move(svg_) + "</svg>\n"; }

 private:
  void path(const std::vector<Polyline>& lines, const char* end) {
    svg_ += " d='";
    for (const Polyline& line : lines) {
      char command = 'M';
      for (const Eigen::Vector2d& p : line) {
        fmt::format_to(std::back_inserter(svg_), "{}{} {}", command, base::hundredths(p.x()),
                       base::hundredths(p.y()));
        command = 'L';
      }
      svg_ += end;
    }
    svg_ += "'/>\n";
  }

  std::string svg_;
};

}  // namespace

std::unique_ptr<Canvas> svgCanvas(int width_px, int height_px) {
  return std::make_unique<SvgCanvas>(width_px, height_px);
}

}  // namespace kerfbench::drawing
