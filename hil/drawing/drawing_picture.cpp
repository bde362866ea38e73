// SPDX-License-Identifier: Apache-2.0
#include "hil/drawing/drawing_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hil/base/chart.h"
#include "hil/base/text.h"
#include "hil/dieline/curve_math.h"
#include "hil/dieline/outlines.h"
#include "hil/drawing/canvas.h"

namespace kerfbench::drawing {
namespace {

using dieline::Process;
using Eigen::Vector2d;

constexpr double kMargin_px = 64.0;   // Around the drawing: room for the scales.
constexpr double kTitle_px = 40.0;    // Height of the first line.
constexpr double kRow_px = 22.0;      // Height of a row below the drawing.
constexpr double kLetters_px = 14.0;  // Height of letters.
constexpr double kNumbers_px = 60.0;  // Least distance of the scale's numbers.
constexpr double kTallest = 1.0;      // Height of the drawing's frame over its width, at most.
constexpr double kLetterWidth = 0.5;  // Mean width of a letter over its height.
constexpr std::size_t kMostFaults = 20;
constexpr std::size_t kMostRows = 40;  // Rows of layers and of notes.

constexpr Colour kInk = 0x1c2028;
constexpr Colour kScale = 0x8a8f98;
constexpr Colour kGrid = 0xe9ebee;
constexpr Colour kBoard = 0xf1e3c8;
constexpr Colour kError = 0xb00020;
constexpr Colour kWarning = 0xb36b00;

Pen penOf(Process process) {
  switch (process) {
    case Process::kCut:
      return {0xd01818, 1.8, 0.0};
    case Process::kHalfCut:
      return {0xc06000, 1.8, 10.0};
    case Process::kCrease:
      return {0x1848c8, 1.8, 6.0};
    case Process::kPerforation:
      return {0x0a7d3c, 1.8, 3.0};
    case Process::kIgnore:
      break;
  }
  return {0xa0a4aa, 1.0, 0.0};
}

/// What one process does on one layer.
struct LayerRow {
  std::size_t lines{};
  double length_mm{};
};
using LayerRows = std::map<std::pair<Process, std::string>, LayerRow>;

LayerRows layersOf(const dieline::Dieline& dieline) {
  LayerRows rows;
  for (const dieline::Entity& entity : dieline.entities) {
    LayerRow& row = rows[{entity.process, entity.layer}];
    ++row.lines;
    row.length_mm += dieline::lengthOf(entity.curve);
  }
  return rows;
}

/// Text in lines of at most `most` letters, broken at blanks where it has some.
std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (text.size() - begin > most) {
    const std::size_t blank = text.rfind(' ', begin + most);
    const bool found = blank != std::string::npos && blank > begin;
    std::size_t end = found ? blank : begin + most;
    // A letter beyond ASCII stays whole.
    while (!found && end > begin + 1 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    lines.push_back(text.substr(begin, end - begin));
    begin = end + (found ? 1 : 0);
  }
  lines.push_back(text.substr(begin));
  return lines;
}

/// A row of text below the drawing, maybe with a sample of a line or a numbered mark before it.
struct TextRow {
  std::string text;
  Pen sample{};        ///< Width 0: none.
  std::string number;  ///< Empty: no mark.
  Colour colour{kInk};
};

bool errorsFirst(const dieline::LintFinding& a, const dieline::LintFinding& b) {
  return a.is_error && !b.is_error;
}

std::string counted(std::size_t number, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", number, number == 1 ? one : many);
}

/// Everything that is on the picture, before its size is known.
class Sheet {
 public:
  Sheet(const dieline::Dieline& dieline, const PictureContent& content)
      : dieline_(dieline), content_(content), findings_(content.findings) {
    if (content.width_px < 400 || content.width_px > 8192)
      throw std::invalid_argument("the width of a picture is 400 to 8192 px");
    bool is_finite = true;
    for (const dieline::Entity& entity : dieline.entities) {
      is_finite = is_finite && std::isfinite(dieline::lengthOf(entity.curve));
      box_.extend(dieline::boundsOf(entity.curve));
    }
    if (box_.isEmpty() || !is_finite || !box_.sizes().allFinite())
      throw std::invalid_argument("there is no line in this drawing");
    const double least = std::max(1.0, 0.02 * box_.sizes().maxCoeff());
    for (int axis = 0; axis < 2; ++axis) {
      const double room = std::max(0.0, 0.5 * (least - box_.sizes()[axis]));
      box_.min()[axis] -= room;
      box_.max()[axis] += room;
    }
    std::stable_sort(findings_.begin(), findings_.end(), errorsFirst);
    const double frame_px = content.width_px - 2.0 * kMargin_px;
    px_per_mm_ = std::min(frame_px / box_.sizes().x(), kTallest * frame_px / box_.sizes().y());
    left_px_ = kMargin_px + 0.5 * (frame_px - px_per_mm_ * box_.sizes().x());
    layOutRows();
  }

  [[nodiscard]] int height_px() const {
    return static_cast<int>(std::ceil(rowsTop() + kRow_px * static_cast<double>(rows_.size()) + 12.0));
  }

  void paint(Canvas& canvas) const {
    canvas.text({12.0, 26.0}, base::printable(title(), 200), 18.0, kInk, Anchor::kStart);
    paintPieces(canvas);
    paintScales(canvas);
    paintLines(canvas);
    paintMarks(canvas);
    double y_px = rowsTop() + kRow_px;
    for (const TextRow& row : rows_) {
      if (row.sample.width_px > 0.0) canvas.strokes({{{16.0, y_px - 5.0}, {64.0, y_px - 5.0}}}, row.sample);
      if (!row.number.empty()) mark(canvas, {40.0, y_px - 5.0}, row.number, row.colour);
      canvas.text({76.0, y_px}, row.text, kLetters_px, row.colour, Anchor::kStart);
      y_px += kRow_px;
    }
  }

 private:
  [[nodiscard]] double rowsTop() const {
    return kTitle_px + 2.0 * kMargin_px + px_per_mm_ * box_.sizes().y();
  }
  [[nodiscard]] Vector2d px(const Vector2d& p_mm) const {
    return {left_px_ + px_per_mm_ * (p_mm.x() - box_.min().x()),
            kTitle_px + kMargin_px + px_per_mm_ * (box_.max().y() - p_mm.y())};
  }
  /// Pieces that leave a circle of that length by no more than 0.02 px, within limits.
  [[nodiscard]] std::vector<double> stationsOf(const dieline::Curve& curve) const {
    if (std::holds_alternative<dieline::LineCurve>(curve)) return {0.0, 1.0};
    const double length_mm = dieline::lengthOf(curve);
    const double pieces =
        std::clamp(std::sqrt(std::numbers::pi * px_per_mm_ * length_mm / (4.0 * 0.02)), 12.0, 96.0);
    return dieline::stations(curve, std::max(1e-6, length_mm / pieces));
  }
  [[nodiscard]] Polyline lineOf(const dieline::Curve& curve) const {
    Polyline line;
    for (const double u : stationsOf(curve)) line.push_back(px(dieline::pointAt(curve, u)));
    return line;
  }

  [[nodiscard]] std::string title() const {
    const dieline::Outlines outlines = dieline::outlinesOf(dieline_, Process::kCut);
    std::size_t holes = 0;
    for (const int nesting : dieline::nestingsOf(outlines)) holes += nesting % 2 == 1 ? 1 : 0;
    std::string text = content_.title;
    const Eigen::AlignedBox2d box = dieline_.bounds();
    if (!box.isEmpty()) text += fmt::format(": {:.2f} x {:.2f} mm", box.sizes().x(), box.sizes().y());
    text += ", " + counted(outlines.closed.size() - holes, "outline", "outlines");
    text += ", " + counted(holes, "hole", "holes");
    if (!outlines.open.empty())
      text += ", " + counted(outlines.open.size(), "cut that is not closed", "cuts that are not closed");
    return text;
  }

  void addText(TextRow row) {
    const auto most = static_cast<std::size_t>((content_.width_px - 96.0) / (kLetterWidth * kLetters_px));
    for (const std::string& line : wrapped(row.text, most)) {
      row.text = line;
      rows_.push_back(row);
      row.sample = {.width_px = 0.0};
      row.number.clear();
    }
  }
  void addLayers() {
    const LayerRows layers = layersOf(dieline_);
    std::size_t shown = 0;
    for (const auto& [key, row] : layers) {
      if (++shown > kMostRows) continue;
      addText({fmt::format("{}, layer {}: {}, {:.1f} mm", dieline::processName(key.first),
                           key.second.empty() ? "-" : base::printable(key.second),
                           counted(row.lines, "line", "lines"), row.length_mm),
               penOf(key.first), "", kInk});
    }
    if (shown > kMostRows)
      addText({fmt::format("and {} more layers", shown - kMostRows), {.width_px = 0.0}, "", kInk});
  }
  void layOutRows() {
    addLayers();
    for (std::size_t i = 0; i < std::min(kMostFaults, findings_.size()); ++i) {
      const dieline::LintFinding& finding = findings_[i];
      addText({fmt::format("{}: {}", finding.is_error ? "error" : "warning",
                           base::printable(finding.message, 400)),
               {.width_px = 0.0},
               std::to_string(i + 1),
               finding.is_error ? kError : kWarning});
    }
    if (findings_.size() > kMostFaults) {
      addText({fmt::format("and {} more, marked without a number", findings_.size() - kMostFaults),
               {.width_px = 0.0},
               "",
               kInk});
    }
    for (std::size_t i = 0; i < std::min(kMostRows, content_.notes.size()); ++i)
      addText({base::printable(content_.notes[i], 400), {.width_px = 0.0}, "", kInk});
  }

  void paintPieces(Canvas& canvas) const {
    std::vector<Polyline> polygons;
    for (const dieline::Outline& outline : dieline::outlinesOf(dieline_, Process::kCut).closed) {
      Polyline& polygon = polygons.emplace_back();
      for (const Vector2d& p_mm : outline.polygon_mm) polygon.push_back(px(p_mm));
    }
    canvas.fill(polygons, kBoard);
  }
  void paintScales(Canvas& canvas) const {
    const Vector2d low = px(box_.min());
    const Vector2d high = px(box_.max());
    // The least round step of numbers that stand kNumbers_px apart: a step and the next differ by 2.5 at
    // most.
    const double step = base::roundStep(4.0 * 2.5 * kNumbers_px / px_per_mm_);
    for (int axis = 0; axis < 2; ++axis) {
      for (double k = std::ceil(box_.min()[axis] / step); k * step <= box_.max()[axis]; k += 1.0) {
        const double value = k * step + 0.0;
        Vector2d at_mm = box_.min();
        at_mm[axis] = value;
        const Vector2d at = px(at_mm);
        const Vector2d first =
            axis == 0 ? Vector2d(at.x(), low.y() + 14.0) : Vector2d(low.x() - 14.0, at.y());
        const Vector2d last = axis == 0 ? Vector2d(at.x(), high.y()) : Vector2d(high.x(), at.y());
        const Vector2d edge = axis == 0 ? Vector2d(at.x(), low.y() + 8.0) : Vector2d(low.x() - 8.0, at.y());
        canvas.strokes({{edge, last}}, {value == 0.0 ? kScale : kGrid, 1.0, 0.0});
        canvas.strokes({{first, edge}}, {kScale, 1.0, 0.0});
        canvas.text(axis == 0 ? Vector2d(at.x(), low.y() + 30.0) : Vector2d(low.x() - 18.0, at.y() + 5.0),
                    fmt::format("{:g}", value), 12.0, kInk, axis == 0 ? Anchor::kMiddle : Anchor::kEnd);
      }
    }
    canvas.text({high.x(), low.y() + 48.0}, "x, y in mm", 12.0, kScale, Anchor::kEnd);
  }
  void paintLines(Canvas& canvas) const {
    // What is not made lies below what is, cuts above all.
    for (const Process process :
         {Process::kIgnore, Process::kPerforation, Process::kCrease, Process::kHalfCut, Process::kCut}) {
      std::vector<Polyline> lines;
      for (const dieline::Entity& entity : dieline_.entities)
        if (entity.process == process) lines.push_back(lineOf(entity.curve));
      canvas.strokes(lines, penOf(process));
    }
  }
  static void mark(Canvas& canvas, const Vector2d& at, const std::string& number, Colour colour) {
    canvas.disc(at, number.empty() ? 4.0 : 10.0, colour);
    if (!number.empty()) canvas.text(at + Vector2d(0.0, 4.0), number, 12.0, 0xffffff, Anchor::kMiddle);
  }
  void paintMarks(Canvas& canvas) const {
    // From the last to the first: errors lie above.
    for (std::size_t i = findings_.size(); i-- > 0;) {
      const Vector2d at = px(findings_[i].p_mm);
      if (!at.allFinite()) continue;
      mark(canvas, at, i < kMostFaults ? std::to_string(i + 1) : "",
           findings_[i].is_error ? kError : kWarning);
    }
  }

  const dieline::Dieline& dieline_;
  const PictureContent& content_;
  std::vector<dieline::LintFinding> findings_;
  Eigen::AlignedBox2d box_;
  double px_per_mm_{};
  double left_px_{};
  std::vector<TextRow> rows_;
};

}  // namespace

PictureContent contentOf(const dieline::Dieline& dieline, std::string title, int width_px,
                         const std::set<dieline::LintFinding::Kind>& accepted,
                         const base::ProgressFn& progress) {
  dieline::LintReport report = dieline::lintDieline(dieline, kMostFaults, progress);
  for (dieline::LintFinding& finding : report.findings)
    finding.is_error = finding.is_error && !dieline::isAccepted(finding, accepted);
  std::vector<std::string> notes = dieline.notes;
  for (std::string& sentence : dieline::uncounted(report)) notes.push_back(std::move(sentence));
  return {std::move(title), std::move(report.findings), std::move(notes), width_px};
}

std::string svgOf(const dieline::Dieline& dieline, const PictureContent& content) {
  const Sheet sheet(dieline, content);
  const auto canvas = svgCanvas(content.width_px, sheet.height_px());
  sheet.paint(*canvas);
  return canvas->finished();
}

std::vector<std::uint8_t> pngOf(const dieline::Dieline& dieline, const PictureContent& content) {
  const Sheet sheet(dieline, content);
  const auto canvas = pngCanvas(content.width_px, sheet.height_px());
  sheet.paint(*canvas);
  const std::string bytes = canvas->finished();
  return {bytes.begin(), bytes.end()};
}

}  // namespace kerfbench::drawing
