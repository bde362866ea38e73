// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/annotate.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kerfbench::scene {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar kInk(28, 32, 40);
const cv::Scalar kPaper(246, 248, 250);

/// The same bytes; channels in the order red, green, blue.
cv::Mat matOf(base::PngSamples& picture) {
  return {picture.height_px, picture.width_px, CV_8UC3, picture.bytes.data()};
}

std::vector<std::uint8_t> encode(const cv::Mat& picture) {
  const std::span bytes(picture.data, picture.total() * picture.elemSize());
  return base::encodePng({picture.cols, picture.rows, picture.channels(), 8, bytes}, base::PngEffort::kSmall);
}

// Dark on a light rim: readable on belt and floor alike.
void write(cv::Mat& picture, const std::string& text, const cv::Point& at, double scale) {
  const int thick = std::max(1, static_cast<int>(std::lround(2.0 * scale)));
  cv::putText(picture, text, at, kFont, scale, kPaper, thick + (scale < 0.5 ? 2 : 3), cv::LINE_AA);
  cv::putText(picture, text, at, kFont, scale, kInk, thick, cv::LINE_AA);
}

cv::Size sizeOf(const std::string& text, double scale) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, scale, 1, &baseline);
}

void writeLabels(cv::Mat& picture, const std::vector<twin::SceneLabel>& labels, const Viewpoint& view,
                 double scale) {
  for (const twin::SceneLabel& label : labels) {
    const auto place = view.project(label.p_W_mm);
    if (!place || place->x() < 0 || place->y() < 0 || place->x() >= picture.cols ||
        place->y() >= picture.rows) {
      continue;
    }
    const cv::Size size = sizeOf(label.text, scale);
    // A single letter is centred on its place; a longer text begins next to it.
    const int left = static_cast<int>(std::lround(place->x())) +
                     (label.text.size() > 1 ? size.height / 2 : -size.width / 2);
    write(picture, label.text, {left, static_cast<int>(std::lround(place->y())) + size.height / 2}, scale);
  }
}

void setIn(cv::Mat& picture, Inset& inset, double scale) {
  cv::Mat small = matOf(inset.picture);
  writeLabels(small, inset.labels, inset.view, 0.8 * scale);
  const int margin = std::max(4, picture.cols / 80);
  const cv::Rect place(picture.cols - small.cols - margin, margin, small.cols, small.rows);
  small.copyTo(picture(place));
  cv::rectangle(picture, place, kPaper, 3, cv::LINE_8);
  cv::rectangle(picture, place, kInk, 1, cv::LINE_8);
}

}  // namespace

std::vector<std::uint8_t> annotate(base::PngSamples samples, const std::vector<twin::SceneLabel>& labels,
                                   const Viewpoint& view, const std::string& caption,
                                   std::optional<Inset> inset) {
  cv::Mat picture = matOf(samples);
  const double scale = std::clamp(picture.cols / 1900.0, 0.35, 1.6);
  writeLabels(picture, labels, view, scale);
  if (inset) setIn(picture, *inset, scale);
  write(picture, caption, {static_cast<int>(14 * scale) + 6, picture.rows - static_cast<int>(12 * scale) - 6},
        scale);
  return encode(picture);
}

}  // namespace kerfbench::scene
