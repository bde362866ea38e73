// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_faults.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include <Eigen/LU>

#include "hil/vision/marks/mark_look.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr int kDarkGray = 4;  // Least light through the board that shows a kerf.
constexpr double kSaturatedShare = 0.02;
constexpr double kInk = 0.6;           // Share of the radius within which all is ink.
constexpr double kBoard = 1.25;        // Share of the radius from which on, up to kOuterRim, all is board.
constexpr double kMarkBlurPx = 0.015;  // Scatter of one mark of 100 px; counts as kBlurBelief marks.
constexpr double kBlurBelief = 4.0;
constexpr double kPrintEdgePx = 0.006;  // Blur that a sharp print seemed to have.
/// Half width of the rim that counts: pixels farther from the edge add nothing but noise.
constexpr double kEdgePx = 4.0;
constexpr std::size_t kNamed = 8;  // Most pictures that one sentence names.

/// Means of ink and board about a disc.
struct Levels {
  double ink{}, board{};
  int ink_count{}, board_count{};
};

}  // namespace

double edgeBlurPx(const GrayImage& image, const CameraCalibration& calibration, const FoundMark& mark,
                  double noise_gray) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const LocalPixelMap map = calibration.localMap(mark.p_mm);
  const Eigen::Matrix2d mm_per_pixel = map.pixel_per_mm.inverse();
  const double pitch_mm = std::sqrt(std::abs(mm_per_pixel.determinant()));
  const double radius_px = 0.5 * mark.diameter_mm / pitch_mm;
  const double reach_px = 1.1 * kOuterRim * radius_px;
  const Eigen::Vector2d& centre = mark.pixel;
  if (centre.x() < reach_px || centre.y() < reach_px || centre.x() > image.width - 1 - reach_px ||
      centre.y() > image.height - 1 - reach_px)
    return kNan;
  const std::optional<PixelBox> box = boxAround(image, centre, reach_px);
  if (!box) return kNan;
  const auto radiusAt = [&](int column, int row) {
    return (mm_per_pixel * (Eigen::Vector2d(column, row) - centre)).norm() / pitch_mm / radius_px;
  };
  Levels levels;
  for (int r = box->top; r <= box->bottom; ++r) {
    for (int c = box->left; c <= box->right; ++c) {
      const double at = radiusAt(c, r);
      if (at < kInk) {
        levels.ink += image.gray(c, r);
        ++levels.ink_count;
      } else if (at > kBoard && at < kOuterRim) {
        levels.board += image.gray(c, r);
        ++levels.board_count;
      }
    }
  }
  if (levels.ink_count == 0 || levels.board_count == 0) return kNan;
  levels.ink /= levels.ink_count;
  levels.board /= levels.board_count;
  const double contrast = levels.board - levels.ink;
  if (!(contrast > 0.0)) return kNan;
  const double noise = noise_gray / contrast;
  double sum = 0.0;
  for (int r = box->top; r <= box->bottom; ++r) {
    for (int c = box->left; c <= box->right; ++c) {
      const double at = radiusAt(c, r);
      if (at < kInk || at > kBoard || std::abs(at - 1.0) * radius_px > kEdgePx) continue;
      const double darkness = (levels.board - image.gray(c, r)) / contrast;
      sum += darkness * (1.0 - darkness) + noise * noise;
    }
  }
  return std::sqrt(std::numbers::pi) * sum / (2.0 * std::numbers::pi * radius_px);
}

LensBlur blurOf(const std::vector<TileView>& tiles, const CameraCalibration& calibration) {
  std::vector<double> blur_px;
  for (const TileView& view : tiles) {
    for (const FoundMark& mark : view.marks) {
      const double blur = edgeBlurPx(view.tile.image, calibration, mark, view.noise_gray);
      if (std::isfinite(blur)) blur_px.push_back(blur);
    }
  }
  if (blur_px.empty()) return kUsualBlur;
  const double median = upperMedianIn(blur_px);
  const auto n = static_cast<double>(blur_px.size());
  double squares = kBlurBelief * kMarkBlurPx * kMarkBlurPx;
  for (const double blur : blur_px) squares += (blur - median) * (blur - median);
  return {median, std::hypot(std::sqrt(squares / (kBlurBelief + n) / n), kPrintEdgePx)};
}

void tellTileFaults(const std::vector<TileView>& tiles, int unit, const LensBlur& blur, double widest_blur_px,
                    std::vector<std::string>& problems) {
  const std::string name = "unit " + std::to_string(unit) + ": ";
  const auto tell = [&](auto&& unfit, const char* what) {
    std::vector<std::size_t> which;  // From 1, as people count.
    for (std::size_t i = 0; i < tiles.size(); ++i)
      if (unfit(*tiles[i].background)) which.push_back(i + 1);
    if (which.empty()) return;
    std::string text = name + std::to_string(which.size()) + " of " + std::to_string(tiles.size()) +
                       " pictures of the kerf camera are " + what + ": number";
    for (std::size_t i = 0; i < std::min(which.size(), kNamed); ++i)
      text += (i == 0 ? " " : ", ") + std::to_string(which[i]);
    problems.push_back(text + (which.size() > kNamed ? " …" : ""));
  };
  tell([](const Background& b) { return b.median() < kDarkGray; }, "dark");
  tell([](const Background& b) { return b.saturatedShare() > kSaturatedShare; }, "saturated");
  tell([](const Background& b) { return b.lifeless(); }, "without any noise");
  if (!(blur.px > widest_blur_px)) return;
  std::ostringstream text;
  text.precision(3);
  text << name << "the pictures of the kerf camera are blurred by " << blur.px << " px, more than "
       << widest_blur_px;
  problems.push_back(text.str());
}

}  // namespace kerfbench::vision
