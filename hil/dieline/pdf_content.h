// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "hil/dieline/faults.h"
#include "hil/dieline/pdf_clip.h"
#include "hil/dieline/pdf_document.h"

namespace kerfbench::dieline {

/// What a stroke is drawn with.
struct PdfPaint {
  const PdfColourSpace* space{};   ///< The stroke's; of the document, or of a device.
  std::vector<double> components;  ///< As many as the space has.
  bool is_dashed{};
  std::vector<std::size_t> groups;  ///< Layers around it, outermost first; places in PdfDocument::groups.
  bool operator==(const PdfPaint&) const = default;
};

/// The curves of one stroked path, in mm in S.
struct PdfStroke {
  std::vector<Curve> curves;
  PdfPaint paint;
  std::size_t number{};  ///< Number of the painted path, counted from 1 over the page with its forms.
};

/// What the page draws besides strokes that are seen, by name ("fills"), and how often.
using PdfIgnored = std::map<std::string, std::size_t>;

/// Takes what the page draws.
class PdfSink {
 public:
  PdfSink() = default;
  PdfSink(const PdfSink&) = delete;
  PdfSink& operator=(const PdfSink&) = delete;
  virtual ~PdfSink() = default;
  virtual void take(const PdfStroke& stroke) = 0;
  /// A path that would be stroked, if its layers were shown.
  virtual void takeHidden(const PdfPaint& paint) = 0;
};

/// Draws the page into `sink`. Curves are exact: lines, and cubic Béziers.
/// @throws DielineError for a content that is broken, has no end or too many entities; other faults are
/// added: a stroke that a clip cuts in two, a soft mask.
PdfIgnored drawPdf(const PdfDocument& document, FaultList& faults, PdfSink& sink);

/// Curves of all strokes of the page, hidden ones included, without drawing them.
std::size_t countPdfStrokes(const PdfDocument& document, FaultList& faults);

}  // namespace kerfbench::dieline
