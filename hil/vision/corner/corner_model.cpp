// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr int kSamples = 2;   // Per pixel, each path.
constexpr int kMarginPx = 3;  // Around the picture, for the blur.
constexpr int kMarginSamples = kSamples * kMarginPx;
constexpr int kModelArcPieces = 12;
constexpr float kFarRadii = 2.4F;  // Farther off there is less than 1e-5 of the middle.
constexpr float kSqrt2 = std::numbers::sqrt2_v<float>;

/// What a leg adds, ready to be asked at many places.
struct LegLight {
  float peak, end_mm, per_radius, cosine, offset_mm, slope, half_curvature, sixth_twist;

  LegLight(const CornerLeg& leg, double peak_share, double end, double radius_mm)
      : peak(static_cast<float>(peak_share)),
        end_mm(static_cast<float>(end)),
        per_radius(static_cast<float>(1.0 / radius_mm)),
        cosine(static_cast<float>(1.0 / std::hypot(1.0, leg.slope))),
        offset_mm(static_cast<float>(leg.offset_mm)),
        slope(static_cast<float>(leg.slope)),
        half_curvature(static_cast<float>(leg.curvature_per_mm / 2.0)),
        sixth_twist(static_cast<float>(leg.twist_per_mm2 / 6.0)) {}

  [[nodiscard]] float shareAt(float along_mm, float beside_mm) const {
    const float beyond = (end_mm - along_mm) * per_radius;
    if (beyond > kFarRadii) return 0.0F;
    const float bent_mm = std::max(0.0F, along_mm);
    const float line_mm =
        offset_mm + slope * along_mm + bent_mm * bent_mm * (half_curvature + sixth_twist * bent_mm);
    const float n = (beside_mm - line_mm) * cosine * per_radius;
    if (std::abs(n) > kFarRadii) return 0.0F;
    const float across = peak * std::exp(-2.0F * n * n);
    return beyond < -kFarRadii ? across : across * 0.5F * std::erfc(kSqrt2 * beyond);
  }
};

struct Piece {
  Eigen::Vector2f p_mm;
  float share;
};

/// The arc in short pieces, which each add their share times a Gaussian of the distance.
std::vector<Piece> piecesOf(const CornerPath& path, const CornerLight& light) {
  const double per_mm =
      0.5 * (light.peak_in + light.peak_out) * std::sqrt(2.0 / std::numbers::pi) / light.beam_radius_mm;
  std::vector<Piece> pieces;
  for (std::size_t i = 1; i < path.arc.size(); i += 2) {
    const double length_mm = (path.arc[i] - path.arc[i - 1]).norm() + (path.arc[i + 1] - path.arc[i]).norm();
    pieces.push_back({path.arc[i].cast<float>(), static_cast<float>(per_mm * length_mm)});
  }
  return pieces;
}

std::vector<float> kernelOf(double blur_px) {
  // A pixel's samples stand for its area, and so for a part of the blur.
  constexpr double kOfSamples_px2 = (1.0 - 1.0 / (kSamples * kSamples)) / 12.0;
  const auto sigma =
      static_cast<float>(kSamples * std::sqrt(std::max(0.01, blur_px * blur_px - kOfSamples_px2)));
  const int reach = std::min(kMarginSamples, static_cast<int>(std::ceil(3.5F * sigma)));
  std::vector<float> kernel;
  float sum = 0.0F;
  for (int k = -reach; k <= reach; ++k) {
    const float x = static_cast<float>(k) / sigma;
    kernel.push_back(std::exp(-0.5F * x * x));
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

}  // namespace

CornerModel::CornerModel(const PixelGrid& grid, const std::vector<bool>& counts, const CornerShape& legs)
    : columns_(kSamples * (grid.columns + 2 * kMarginPx)),
      rows_(kSamples * (grid.rows + 2 * kMarginPx)),
      pixel_columns_(grid.columns),
      pixel_rows_(grid.rows) {
  sharp_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  across_.resize(sharp_.size());
  std::vector<bool> needed(sharp_.size(), false);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (!counts[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.columns) +
                  static_cast<std::size_t>(c)])
        continue;
      for (int y = kSamples * r; y < kSamples * (r + 1 + 2 * kMarginPx); ++y) {
        const auto line = needed.begin() + static_cast<std::ptrdiff_t>(y) * columns_;
        std::fill(line + kSamples * c, line + kSamples * (c + 1 + 2 * kMarginPx), true);
      }
    }
  }
  const auto placeOf = [](std::size_t sample) {
    return (static_cast<double>(sample) + 0.5) / kSamples - kMarginPx - 0.5;
  };
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    const Vector2d p_mm = grid.at(placeOf(i % columns), placeOf(i / columns));
    const CornerLeg::Place in = legs.in.placeOf(p_mm);
    const CornerLeg::Place out = legs.out.placeOf(p_mm);
    samples_.push_back({i, p_mm.cast<float>(), static_cast<float>(in.along_mm),
                        static_cast<float>(in.beside_mm), static_cast<float>(out.along_mm),
                        static_cast<float>(out.beside_mm)});
  }
}

void CornerModel::render(CornerShape shape, const CornerLight& light, std::vector<float>& gray) {
  shape.in.offset_mm += light.scorch_in_mm;
  shape.out.offset_mm += light.scorch_out_mm;
  const CornerPath path = pathOf(shape, 2 * kModelArcPieces);
  const LegLight in(shape.in, light.peak_in, path.end_in_mm, light.beam_radius_mm);
  const LegLight out(shape.out, light.peak_out, path.end_out_mm, light.beam_radius_mm);
  const std::vector<Piece> arc = piecesOf(path, light);
  const auto per_radius2 = static_cast<float>(2.0 / (light.beam_radius_mm * light.beam_radius_mm));
  const auto board = static_cast<float>(light.board_gray);
  const auto open = static_cast<float>(light.open_gray);
  const FastLaw law(light.board_gray / light.open_gray, light.growth);
  for (const Sample& sample : samples_) {
    float share = in.shareAt(sample.in_along_mm, sample.in_beside_mm) +
                  out.shareAt(sample.out_along_mm, sample.out_beside_mm);
    for (const Piece& piece : arc) {
      const float d2 = (sample.p_mm - piece.p_mm).squaredNorm() * per_radius2;
      if (d2 < 2.0F * kFarRadii * kFarRadii) share += piece.share * std::exp(-d2);
    }
    sharp_[sample.index] = share > 0.0F ? open * law.lightAt(share) : board;
  }
  blur(light.blur_px);
  gray.resize(static_cast<std::size_t>(pixel_columns_) * static_cast<std::size_t>(pixel_rows_));
  std::size_t pixel = 0;
  for (int r = 0; r < pixel_rows_; ++r) {
    for (int c = 0; c < pixel_columns_; ++c) {
      float sum = 0.0F;
      for (int y = 0; y < kSamples; ++y) {
        const float* line = sharp_.data() +
                            static_cast<std::ptrdiff_t>(kSamples * (r + kMarginPx) + y) * columns_ +
                            kSamples * (c + kMarginPx);
        for (int x = 0; x < kSamples; ++x) sum += line[x];
      }
      gray[pixel++] = sum / static_cast<float>(kSamples * kSamples);
    }
  }
}

void CornerModel::blur(double blur_px) {
  const std::vector<float> kernel = kernelOf(blur_px);
  const int reach = static_cast<int>(kernel.size()) / 2;
  const auto lineOf = [this](std::vector<float>& image, int row) {
    return image.data() + static_cast<std::ptrdiff_t>(row) * columns_;
  };
  const int first = kMarginSamples;
  for (int r = 0; r < rows_; ++r) {
    const float* from = lineOf(sharp_, r);
    float* to = lineOf(across_, r);
    std::fill(to, to + columns_, 0.0F);
    for (int k = -reach; k <= reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      for (int c = first; c < columns_ - first; ++c) to[c] += weight * from[c + k];
    }
  }
  for (int r = first; r < rows_ - first; ++r) {
    float* to = lineOf(sharp_, r);
    std::fill(to, to + columns_, 0.0F);
    for (int k = -reach; k <= reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      const float* from = lineOf(across_, r + k);
      for (int c = first; c < columns_ - first; ++c) to[c] += weight * from[c];
    }
  }
}

}  // namespace kerfbench::vision
