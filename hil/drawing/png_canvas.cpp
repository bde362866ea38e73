// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/base/png_codec.h"
#include "hil/drawing/canvas.h"

namespace kerfbench::drawing {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeight_px = 30.0;  // Line height of that font at scale 1.
constexpr int kFractionBits = 4;         // OpenCV draws to 1/16 of a pixel.

// The channels are in the order of a PNG: red, green, blue.
cv::Scalar scalarOf(Colour colour) {
  return {double((colour >> 16) & 255), double((colour >> 8) & 255), double(colour & 255)};
}

cv::Point fixed(const Eigen::Vector2d& p) {
  constexpr double kOne = 1 << kFractionBits;
  return {static_cast<int>(std::lround(p.x() * kOne)), static_cast<int>(std::lround(p.y() * kOne))};
}

std::vector<cv::Point> fixedPoints(const Polyline& line) {
  std::vector<cv::Point> points;
  points.reserve(line.size());
  for (const Eigen::Vector2d& p : line) points.push_back(fixed(p));
  return points;
}

// The parts of a line that are drawn where it is dashed.
std::vector<Polyline> dashes(const Polyline& line, double dash_px) {
  std::vector<Polyline> parts;
  double left = dash_px;
  bool drawn = true;
  if (!line.empty()) parts.push_back({line.front()});
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d way = line[i] - line[i - 1];
    const double length = way.norm();
    double done = 0.0;
    while (length - done > left) {
      done += left;
      left = dash_px;
      const Eigen::Vector2d at = line[i - 1] + way * (done / length);
      if (drawn) parts.back().push_back(at);
      if (!drawn) parts.push_back({at});
      drawn = !drawn;
    }
    left -= length - done;
    if (drawn) parts.back().push_back(line[i]);
  }
  return parts;
}

// Hershey's fonts have the letters of ASCII alone.
std::string asciiOf(const std::string& text) {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) ascii += c;
    if (byte >= 0xC0) ascii += '?';
  }
  return ascii;
}

class PngCanvas : public Canvas {
 public:
  PngCanvas(int width_px, int height_px) : picture_(height_px, width_px, CV_8UC3, scalarOf(0xffffff)) {}

  void strokes(const std::vector<Polyline>& lines, const Pen& pen) override {
    const int thickness = std::max(1, static_cast<int>(std::lround(pen.width_px)));
    const auto draw = [&](const Polyline& line) {
      cv::polylines(picture_, fixedPoints(line), false, scalarOf(pen.colour), thickness, cv::LINE_AA,
                    kFractionBits);
    };
    for (const Polyline& line : lines) {
      if (pen.dash_px > 0.0) {
        std::ranges::for_each(dashes(line, pen.dash_px), draw);
      } else {
        draw(line);
      }
    }
  }
  void fill(const std::vector<Polyline>& polygons, Colour colour) override {
    std::vector<std::vector<cv::Point>> points;
    for (const Polyline& polygon : polygons) points.push_back(fixedPoints(polygon));
    if (!points.empty()) cv::fillPoly(picture_, points, scalarOf(colour), cv::LINE_8, kFractionBits);
  }
  void disc(const Eigen::Vector2d& centre, double radius_px, Colour colour) override {
    const int radius = static_cast<int>(std::lround(radius_px * (1 << kFractionBits)));
    cv::circle(picture_, fixed(centre), radius, scalarOf(colour), cv::FILLED, cv::LINE_AA, kFractionBits);
  }
  void text(const Eigen::Vector2d& at, const std::string& text, double height_px, Colour colour,
            Anchor anchor) override {
    const std::string ascii = asciiOf(text);
    const double scale = height_px / kFontHeight_px;
    int baseline = 0;
    const int width = cv::getTextSize(ascii, kFont, scale, 1, &baseline).width;
    const int shift = anchor == Anchor::kStart ? 0 : anchor == Anchor::kMiddle ? width / 2 : width;
    const cv::Point place(static_cast<int>(std::lround(at.x())) - shift,
                          static_cast<int>(std::lround(at.y())));
    cv::putText(picture_, ascii, place, kFont, scale, scalarOf(colour), 1, cv::LINE_AA);
  }
  std::string finished() override {
    const std::span bytes(picture_.data, picture_.total() * picture_.elemSize());
    const auto png = base::encodePng({picture_.cols, picture_.rows, 3, 8, bytes}, base::PngEffort::kSmall);
    return {png.begin(), png.end()};
  }

 private:
  cv::Mat picture_;
};

}  // namespace

std::unique_ptr<Canvas> pngCanvas(int width_px, int height_px) {
  return std::make_unique<PngCanvas>(width_px, height_px);
}

}  // namespace kerfbench::drawing
