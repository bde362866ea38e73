// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hil/vision/kerf/light_law.h"
#include "twin/base/multiversion.h"
#include "twin/base/wide_math.h"

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
};

/// Adds a leg's light at many places.
KERFBENCH_WIDE void addLeg(const LegLight& leg, const std::vector<float>& along_mm,
                           const std::vector<float>& beside_mm, std::vector<float>& share) {
  const float* const along = along_mm.data();
  const float* const beside = beside_mm.data();
  float* const sum = share.data();
  const std::size_t count = share.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float beyond = (leg.end_mm - along[i]) * leg.per_radius;
    const float bent_mm = along[i] > 0.0F ? along[i] : 0.0F;
    const float line_mm = leg.offset_mm + leg.slope * along[i] +
                          bent_mm * bent_mm * (leg.half_curvature + leg.sixth_twist * bent_mm);
    const float off = (beside[i] - line_mm) * leg.cosine * leg.per_radius;
    // Not a number falls to the bound as well.
    const float n2 = off * off < kFarRadii * kFarRadii ? off * off : kFarRadii * kFarRadii;
    const float near = beyond > -kFarRadii ? beyond : -kFarRadii;
    const float end = near < kFarRadii ? near : kFarRadii;
    const float across = leg.peak * wideExp(-2.0F * n2);
    const float light = end > -kFarRadii ? across * 0.5F * wideErfc(kSqrt2 * end) : across;
    const bool seen = n2 < kFarRadii * kFarRadii && end < kFarRadii;
    sum[i] += seen ? light : 0.0F;
  }
}

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

KERFBENCH_WIDE void addPiece(const Piece& piece, float per_radius2, const std::vector<float>& x_mm,
                             const std::vector<float>& y_mm, std::vector<float>& share) {
  constexpr float kFar = 2.0F * kFarRadii * kFarRadii;
  const float* const x = x_mm.data();
  const float* const y = y_mm.data();
  float* const sum = share.data();
  const std::size_t count = share.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - piece.p_mm.x();
    const float dy = y[i] - piece.p_mm.y();
    const float d2 = (dx * dx + dy * dy) * per_radius2;
    const float near = d2 < kFar ? d2 : kFar;
    sum[i] += near < kFar ? piece.share * wideExp(-near) : 0.0F;
  }
}

/// to[c] = sum over k of kernel[k] * from[c + k * step], for the columns [first, last).
KERFBENCH_WIDE void blurRow(const std::vector<float>& kernel, const float* from, std::ptrdiff_t step,
                            int first, int last, float* to) {
  constexpr int kAtOnce = 16;  // Sums that stay in registers.
  int c = first;
  for (; c + kAtOnce <= last; c += kAtOnce) {
    std::array<float, kAtOnce> sum{};
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const float* const moved = from + static_cast<std::ptrdiff_t>(k) * step + c;
      for (std::size_t j = 0; j < kAtOnce; ++j) sum[j] += kernel[k] * moved[j];
    }
    std::copy(sum.begin(), sum.end(), to + c);
  }
  for (; c < last; ++c) {
    to[c] = 0.0F;
    for (std::size_t k = 0; k < kernel.size(); ++k)
      to[c] += kernel[k] * from[static_cast<std::ptrdiff_t>(k) * step + c];
  }
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
    samples_.index.push_back(i);
    samples_.x_mm.push_back(static_cast<float>(p_mm.x()));
    samples_.y_mm.push_back(static_cast<float>(p_mm.y()));
    samples_.in_along_mm.push_back(static_cast<float>(in.along_mm));
    samples_.in_beside_mm.push_back(static_cast<float>(in.beside_mm));
    samples_.out_along_mm.push_back(static_cast<float>(out.along_mm));
    samples_.out_beside_mm.push_back(static_cast<float>(out.beside_mm));
  }
  samples_.share.resize(samples_.index.size());
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
  std::fill(samples_.share.begin(), samples_.share.end(), 0.0F);
  addLeg(in, samples_.in_along_mm, samples_.in_beside_mm, samples_.share);
  addLeg(out, samples_.out_along_mm, samples_.out_beside_mm, samples_.share);
  for (const Piece& piece : arc) addPiece(piece, per_radius2, samples_.x_mm, samples_.y_mm, samples_.share);
  for (std::size_t i = 0; i < samples_.index.size(); ++i) {
    const float share = samples_.share[i];
    sharp_[samples_.index[i]] = share > 0.0F ? open * law.lightAt(share) : board;
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
  for (int r = 0; r < rows_; ++r)
    blurRow(kernel, lineOf(sharp_, r) - reach, 1, first, columns_ - first, lineOf(across_, r));
  for (int r = first; r < rows_ - first; ++r)
    blurRow(kernel, lineOf(across_, r - reach), columns_, first, columns_ - first, lineOf(sharp_, r));
}

}  // namespace kerfbench::vision
