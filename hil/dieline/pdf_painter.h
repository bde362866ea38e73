// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "hil/dieline/pdf_content.h"
#include "hil/dieline/pdf_path.h"

namespace kerfbench::dieline {

/// How a stroke is seen where it is drawn.
struct PdfLook {
  PdfPaint paint;
  bool is_shown{true};   ///< False if the layers around it are hidden.
  bool is_opaque{true};  ///< Not of opacity 0.
  bool has_mask{};       ///< Under a soft mask.
};

/// Paints paths: strokes go to the sink, all others are counted.
class PdfPainter {
 public:
  /// Without a sink strokes are only counted.
  PdfPainter(FaultList& faults, PdfSink* sink) : faults_(faults), sink_(sink) {}

  [[nodiscard]] bool draws() const { return sink_ != nullptr; }
  /// Counts a path that is painted, before it is stroked.
  void count(const PdfPath& path, bool is_filled, bool is_stroked);
  void stroke(const PdfPath& path, const PdfClip& clip, const PdfLook& look);
  /// The clip within the path.
  PdfClip clipped(const PdfClip& clip, const PdfPath& path, bool is_even_odd);

  PdfIgnored ignored;  ///< For all that is not painted by a path, too.
  [[nodiscard]] std::size_t curves() const { return curves_; }

 private:
  FaultList& faults_;
  PdfSink* sink_;
  std::size_t paths_{};
  std::size_t curves_{};
  std::size_t clip_points_{};
  std::size_t clip_work_{};
};

}  // namespace kerfbench::dieline
