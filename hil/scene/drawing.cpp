// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/scene/mesh.h"
#include "hil/scene/raster.h"
#include "hil/scene/shading.h"
#include "hil/scene/strokes.h"

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSamples = 4;    // Samples each way in a pixel.
constexpr int kBandRows = 16;  // Rows of pixels at a time: what they need stays in the cache.

/// 8 bits of sRGB for a linear share.
std::uint8_t encoded(double linear) {
  constexpr int kSteps = 8192;
  static const auto table = [] {
    std::array<std::uint8_t, kSteps + 1> t{};
    for (int i = 0; i <= kSteps; ++i) {
      const double x = static_cast<double>(i) / kSteps;
      const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
      t.at(static_cast<std::size_t>(i)) = static_cast<std::uint8_t>(std::lround(255.0 * y));
    }
    return t;
  }();
  const double share = linear > 0 ? std::min(linear, 1.0) : 0.0;  // Not a number: black.
  return table.at(static_cast<std::size_t>(kSteps * share + 0.5));
}

/// Draws a picture, a few rows at a time.
class Drawing {
 public:
  Drawing(const twin::Scene& scene, const Viewpoint& view)
      : view_(view),
        mesh_(meshOf(scene)),
        shading_(scene, view, mesh_),
        opaque_(seenTriangles(mesh_, view, kSamples, sidesOf(false))),
        clear_(seenTriangles(mesh_, view, kSamples, sidesOf(true))),
        burnt_(burntStrokes(scene, view)),
        beam_(beamStrokes(scene, view)),
        rows_(kSamples * view.width_px(), kSamples * kBandRows),
        band_(static_cast<std::size_t>(view.width_px()) * kBandRows) {}

  base::PngSamples picture() {
    base::PngSamples picture{view_.width_px(), view_.height_px(), 3, 8, {}};
    picture.bytes.reserve(3 * static_cast<std::size_t>(picture.width_px) *
                          static_cast<std::size_t>(picture.height_px));
    for (int row = 0; row < view_.height_px(); row += kBandRows) {
      drawBand(row);
      const int rows = std::min(kBandRows, view_.height_px() - row);
      const std::size_t pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(view_.width_px());
      for (std::size_t i = 0; i < pixels; ++i) {
        for (const double channel : band_[i]) picture.bytes.push_back(encoded(channel));
      }
    }
    return picture;
  }

 private:
  [[nodiscard]] std::vector<Sides> sidesOf(bool clear) const {
    std::vector<Sides> sides;
    sides.reserve(mesh_.faces.size());
    for (const Face& face : mesh_.faces)
      sides.push_back(isClear(face.look) != clear ? Sides::kNone : clear ? Sides::kBoth : Sides::kFront);
    return sides;
  }

  void drawBand(int first_row) {
    first_row_ = first_row;
    rows_.begin(kSamples * first_row);
    for (const SeenTriangle& triangle : opaque_) rows_.draw(triangle);
    for (int row = 0; row < kBandRows; ++row) {
      for (int x = 0; x < view_.width_px(); ++x) band_[index(x, row)] = partsAt(x, first_row + row);
    }
    drawBurnt();
    for (const Look look : {Look::kTube, Look::kGlass}) drawClear(look);
    for (const Stroke& stroke : beam_) {
      forEachPixel(stroke, [&](std::size_t i, double cover) {
        band_[i] += cover * (colourOf(stroke.kind) - band_[i]);
      });
    }
  }

  [[nodiscard]] std::size_t index(int x, int row_of_band) const {
    return static_cast<std::size_t>(row_of_band) * static_cast<std::size_t>(view_.width_px()) +
           static_cast<std::size_t>(x);
  }

  /// Through a place of the picture, in samples; its share along `forward` is 1.
  [[nodiscard]] Vector3d rayAt(const Vector2d& sample) const {
    const double scale = 2.0 * view_.half_width_tan() / (kSamples * view_.width_px());
    const Vector2d middle = 0.5 * kSamples * Vector2d(view_.width_px(), view_.height_px());
    const Vector2d off = scale * (sample + Vector2d(0.5, 0.5) - middle);
    return view_.forward() + off.x() * view_.right() - off.y() * view_.up();
  }

  // Each face that a pixel shows is shaded once, in the middle of what is seen of it.
  [[nodiscard]] Colour partsAt(int x, int row) const {
    struct Seen {
      int face{};
      int samples{};
      Vector2d place{Vector2d::Zero()};
      double nearness{};
    };
    std::array<Seen, kSamples * kSamples> seen;
    std::size_t count = 0;
    for (int sy = kSamples * row; sy < kSamples * (row + 1); ++sy) {
      for (int sx = kSamples * x; sx < kSamples * (x + 1); ++sx) {
        const std::size_t i = rows_.at(sy) + static_cast<std::size_t>(sx);
        std::size_t k = 0;
        while (k < count && seen[k].face != rows_.face(i)) ++k;
        if (k == count) seen[count++] = Seen{rows_.face(i)};
        ++seen[k].samples;
        seen[k].place += Vector2d(sx, sy);
        seen[k].nearness += static_cast<double>(rows_.nearness(i));
      }
    }
    Colour sum = Colour::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      const Seen& s = seen[k];
      const Vector3d ray = rayAt(s.place / s.samples);
      const Colour colour = s.face < 0 ? shading_.beyond(ray)
                                       : shading_.face(mesh_.faces[static_cast<std::size_t>(s.face)],
                                                       view_.place_mm() + s.samples / s.nearness * ray);
      // Bright glints are as bright as white before they are mixed: the edge stays smooth.
      sum += s.samples * colour.min(1.0);
    }
    return sum / (kSamples * kSamples);
  }

  /// Calls `paint(pixel, cover)` for each pixel of the band that a stroke covers, hidden parts left out.
  template <typename Paint>
  void forEachPixel(const Stroke& stroke, Paint&& paint) const {
    const Vector2d margin = Vector2d::Constant(stroke.half_px.maxCoeff() + 0.5);
    const Vector2d low = stroke.from_px.cwiseMin(stroke.to_px) - margin;
    const Vector2d high = stroke.from_px.cwiseMax(stroke.to_px) + margin;
    const auto within = [](double v, int least, int most) {
      return static_cast<int>(std::ceil(std::clamp<double>(v, least, most)));
    };
    const int end_row =
        within(high.y() + 1.0, first_row_, std::min(first_row_ + kBandRows, view_.height_px()));
    const int end_x = within(high.x() + 1.0, 0, view_.width_px());
    for (int row = within(low.y(), first_row_, first_row_ + kBandRows); row < end_row; ++row) {
      for (int x = within(low.x(), 0, view_.width_px()); x < end_x; ++x) {
        const auto sample = sampleOf(stroke, Vector2d(x, row));
        if (!sample || !(sample->cover > 0)) continue;
        const double free = freeShare(x, row, sample->nearness * (1.0 + stroke.relief));
        if (free > 0) paint(index(x, row - first_row_), free * sample->cover);
      }
    }
  }

  /// Share of a pixel in which nothing is nearer than that.
  [[nodiscard]] double freeShare(int x, int row, double nearness) const {
    int free = 0;
    for (int sy = kSamples * row; sy < kSamples * (row + 1); ++sy) {
      for (int sx = kSamples * x; sx < kSamples * (x + 1); ++sx)
        free += static_cast<double>(rows_.nearness(rows_.at(sy) + static_cast<std::size_t>(sx))) <= nearness;
    }
    return static_cast<double>(free) / (kSamples * kSamples);
  }

  // Strokes of a cut overlap at its bends, and are no darker there.
  void drawBurnt() {
    std::vector<double> cover(band_.size());
    for (const Stroke& stroke : burnt_)
      forEachPixel(stroke, [&](std::size_t i, double c) { cover[i] = std::max(cover[i], c); });
    for (std::size_t i = 0; i < band_.size(); ++i)
      band_[i] += cover[i] * (colourOf(Stroke::Kind::kBurnt) - band_[i]);
  }

  void drawClear(Look look) {
    const Clear clear = clearOf(look);
    std::vector<double> passes(
        static_cast<std::size_t>(rows_.width()) * static_cast<std::size_t>(rows_.rows()), 1.0);
    bool any = false;
    for (const SeenTriangle& t : clear_) {
      if (mesh_.faces[static_cast<std::size_t>(t.face)].look != look) continue;
      forEachSpan(t, rows_.width(), rows_.first_row(), rows_.first_row() + rows_.rows(),
                  [&](int row, int first, int past) {
                    any = true;
                    for (int x = first; x < past; ++x) {
                      const std::size_t i = rows_.at(row) + static_cast<std::size_t>(x);
                      const double nearness = t.slope.x() * x + t.slope.y() * row + t.offset;
                      if (nearness > static_cast<double>(rows_.nearness(i))) passes[i] *= clear.passes;
                    }
                  });
    }
    if (!any) return;
    for (int row = 0; row < kBandRows; ++row) {
      for (int x = 0; x < view_.width_px(); ++x) {
        double sum = 0.0;
        for (int sy = 0; sy < kSamples; ++sy) {
          const std::size_t start =
              rows_.at(rows_.first_row() + kSamples * row + sy) + static_cast<std::size_t>(kSamples * x);
          for (std::size_t sx = 0; sx < kSamples; ++sx) sum += passes[start + sx];
        }
        Colour& colour = band_[index(x, row)];
        colour = clear.colour + sum / (kSamples * kSamples) * (colour - clear.colour);
      }
    }
  }

  const Viewpoint& view_;
  Mesh mesh_;
  Shading shading_;
  std::vector<SeenTriangle> opaque_, clear_;
  std::vector<Stroke> burnt_, beam_;
  DepthRows rows_;
  int first_row_{};
  std::vector<Colour> band_;
};

}  // namespace

base::PngSamples drawScene(const twin::Scene& scene, const Viewpoint& view) {
  return Drawing(scene, view).picture();
}

}  // namespace kerfbench::scene
