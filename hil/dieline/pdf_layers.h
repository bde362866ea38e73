// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/dieline/pdf_content.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

/// The processing step of a group as a layer, "Structural Cutting"; empty if it is none.
std::string pdfStepName(const PdfGroup& group);
/// What a step of ISO 19593-1 is for a laser above the sheet. Nothing for steps that a rule must decide:
/// those done from the other side, those that cut and crease in turn, and names that the standard does not
/// have.
std::optional<Process> pdfStepProcess(const PdfGroup& group);

/// Names by which a rule may know a colour, the most exact first: the ink, "cmyk 0 100 100 0", "#ff0000".
/// Empty for a stroke without ink.
std::vector<std::string> pdfColourNames(const PdfPaint& paint);

/// The layer of a stroke and its process.
struct PdfLayer {
  std::string name;
  std::optional<Process> process;
  std::string fault;     ///< Why there is no process: the end of a sentence.
  bool is_dash_blind{};  ///< The rule says nothing of dashes, so solid strokes must not share it.
  bool has_ink{true};    ///< Otherwise nothing is seen, and all else is empty.
};

/// Decides by these, the first that fits: the processing step, the innermost layer that a rule names, the
/// colour that a rule names, the rule "*". "NAME dashed" is a rule for dashed strokes alone.
PdfLayer choosePdfLayer(const PdfPaint& paint, const PdfDocument& document, const LayerProfile& profile);

}  // namespace kerfbench::dieline
