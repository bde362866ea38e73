// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_painter.h"

#include <fmt/format.h>

#include "hil/dieline/pdf_operands.h"
#include "hil/dieline/readers.h"

namespace kerfbench::dieline {
namespace {
constexpr std::size_t kMostClipPieces = 20'000;     // Most of one clip.
constexpr std::size_t kMostClipPoints = 2'000'000;  // Most of all clips.
constexpr std::size_t kMostClipWork = 50'000'000;   // Places looked at.
constexpr const char* kIntricate = "its clip paths are too intricate";
}  // namespace

void PdfPainter::count(const PdfPath& path, bool is_filled, bool is_stroked) {
  ++paths_;
  if (path.size() == 0) return;
  if (is_filled) ++ignored[is_stroked ? "fills of stroked paths" : "fills"];
  if (!is_stroked) return;
  curves_ += path.size();
  if (curves_ > kMostEntities) faults_.fatal(0, fmt::format("more than {} entities", kMostEntities));
}

void PdfPainter::stroke(const PdfPath& path, const PdfClip& clip, const PdfLook& look) {
  if (!look.is_shown) {
    sink_->takeHidden(look.paint);
    return;
  }
  if (!look.is_opaque) {
    ++ignored["strokes of opacity 0"];
    return;
  }
  if (look.has_mask)
    faults_.add(0, "a stroke lies under a soft mask; take the mask off, or the stroke out of it");
  PdfStroke stroke;
  stroke.paint = look.paint;
  stroke.number = paths_;
  std::size_t dots = 0;
  for (Curve& curve : path.curves(dots)) {
    const PdfClip::Side side = clip.sideOf(curve, clip_work_);
    if (side == PdfClip::Side::kOutside) {
      ++ignored["lines outside of page or clip"];
    } else if (side == PdfClip::Side::kAcross) {
      const Eigen::Vector2d p_mm = pointAt(curve, 0);
      faults_.add(0,
                  fmt::format("path {}, from ({:.3f}, {:.3f}) mm, is cut off by its clip or by the edge of "
                              "the page; shorten it, or take it out of the clip",
                              paths_, p_mm.x(), p_mm.y()));
    } else {
      stroke.curves.push_back(std::move(curve));
    }
    if (clip_work_ > kMostClipWork) faults_.fatal(0, kIntricate);
  }
  if (dots > 0) ignored["dots"] += dots;
  if (!stroke.curves.empty()) sink_->take(stroke);
}

PdfClip PdfPainter::clipped(const PdfClip& clip, const PdfPath& path, bool is_even_odd) {
  if (path.size() > kMostClipPieces || clip.regions() > kDeepestPdf) faults_.fatal(0, kIntricate);
  PdfRegion region = path.region(is_even_odd);
  for (const auto& polygon : region.polygons_mm) clip_points_ += polygon.size();
  if (clip_points_ > kMostClipPoints) faults_.fatal(0, kIntricate);
  return clip.within(std::move(region));
}

}  // namespace kerfbench::dieline
