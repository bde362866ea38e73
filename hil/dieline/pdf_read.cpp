// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/dieline/pdf_content.h"
#include "hil/dieline/pdf_layers.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// Strokes become entities.
class PdfDrawing : public PdfSink {
 public:
  PdfDrawing(const PdfDocument& document, const LayerProfile& profile, FaultList& faults)
      : document_(document), profile_(profile), faults_(faults) {}

  Dieline read() {
    dieline_.path = faults_.path();
    // What is too much is known before it takes memory.
    dieline_.entities.reserve(countPdfStrokes(document_, faults_));
    const PdfIgnored ignored = drawPdf(document_, faults_, *this);
    for (const auto& [fault, where] : unknown_) {
      const std::string others =
          where.second > 1 ? fmt::format(" (and {} others likewise)", where.second - 1) : "";
      faults_.add(0, fmt::format("path {}{} {}", where.first, others, fault));
    }
    for (const std::string& layer : mixed_) {
      faults_.add(0,
                  fmt::format("{} has solid and dashed strokes, and one rule for both; give the dashed ones "
                              "a rule of their own, {}",
                              inQuotes(layer), inQuotes(layer + " dashed")));
    }
    faults_.throwIfAny();
    note(ignored);
    return std::move(dieline_);
  }

  void take(const PdfStroke& stroke) override {
    const PdfLayer& layer = layerOf(stroke.paint);
    if (!layer.has_ink) {
      ++without_ink_;
      return;
    }
    if (!layer.process) {
      unknown_.try_emplace(layer.fault, stroke.number, 0).first->second.second += 1;
      return;
    }
    if (layer.is_dash_blind && *layer.process != Process::kIgnore) {
      (stroke.paint.is_dashed ? dashed_ : solid_).insert(layer.name);
      if (solid_.contains(layer.name) && dashed_.contains(layer.name)) mixed_.insert(layer.name);
    }
    for (const Curve& curve : stroke.curves) {
      dieline_.entities.push_back({static_cast<int>(dieline_.entities.size()),
                                   curve,
                                   *layer.process,
                                   layer.name,
                                   fmt::format("path {}", stroke.number),
                                   {}});
    }
  }

  void takeHidden(const PdfPaint& paint) override {
    std::string name;
    for (const std::size_t index : paint.groups) {
      const PdfGroup& group = document_.groups[index];
      if (!group.is_visible || name.empty()) name = group.name;
      const std::string step = pdfStepName(group);
      if (group.is_visible || step.empty()) continue;
      const auto process = hasRule(profile_, step) ? processFor(profile_, step) : pdfStepProcess(group);
      if (process == Process::kIgnore) continue;
      faults_.add(0,
                  fmt::format("layer {} is hidden, and a processing step ({}); show it, or give {} the rule "
                              "ignore",
                              inQuotes(group.name), step, inQuotes(step)));
    }
    ++hidden_[name];
  }

 private:
  /// Strokes of one kind come in a row.
  const PdfLayer& layerOf(const PdfPaint& paint) {
    if (!last_ || *last_ != paint) {
      last_ = paint;
      layer_ = choosePdfLayer(paint, document_, profile_);
    }
    return layer_;
  }

  void note(const PdfIgnored& ignored) {
    std::vector<std::string> parts;
    for (const auto& [name, count] : ignored) parts.push_back(fmt::format("{} {}", count, name));
    if (without_ink_ > 0) parts.push_back(fmt::format("{} strokes without ink", without_ink_));
    if (document_.annotations > 0) parts.push_back(fmt::format("{} annotations", document_.annotations));
    if (!parts.empty()) dieline_.notes.push_back(fmt::format("Ignored: {}.", fmt::join(parts, ", ")));
    for (const auto& [name, count] : hidden_)
      dieline_.notes.push_back(
          fmt::format("Ignored: {} paths of the hidden layer {}.", count, inQuotes(name)));
    if (dieline_.entities.empty())
      dieline_.notes.push_back("No line of the page is stroked; a filled shape has no line to follow.");
    if (!document_.warnings.empty()) {
      dieline_.notes.push_back(fmt::format("The file is not quite sound, {} places; the first: {}.",
                                           document_.warnings.size(),
                                           base::printable(document_.warnings.front(), 100)));
    }
  }

  const PdfDocument& document_;
  const LayerProfile& profile_;
  FaultList& faults_;
  Dieline dieline_;
  std::optional<PdfPaint> last_;
  PdfLayer layer_;
  std::set<std::string> solid_;
  std::set<std::string> dashed_;
  std::set<std::string> mixed_;
  std::map<std::string, std::size_t> hidden_;
  /// Why strokes have no process: number of the first path, and how many there are.
  std::map<std::string, std::pair<std::size_t, std::size_t>> unknown_;
  std::size_t without_ink_{};
};

}  // namespace

Dieline readPdf(const std::string& bytes, const DrawingOptions& options, FaultList& faults) {
  if (options.unit) faults.fatal(0, "a PDF file says its unit itself: leave 'unit' out, or use 'scale'");
  const PdfDocument document = readPdfDocument(bytes, options.page, faults);
  return PdfDrawing(document, options.layers, faults).read();
}

}  // namespace kerfbench::dieline
