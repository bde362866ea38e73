// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/print_page.h"

#include <array>
#include <cstdint>
#include <numbers>

#include <fmt/format.h>

#include "hil/base/text.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kBarb_mm = 1.6;
constexpr double kHelveticaWidth = 0.5;  // Mean width of its characters, as a share of the size.

/// Shapes as SVG, with y downwards.
struct SvgShapes {
  double height_mm;
  std::string text;

  void operator()(const PrintPage::Disc& disc) {
    text += fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3f}\"/>\n", disc.p_mm.x(),
                        height_mm - disc.p_mm.y(), disc.radius_mm);
  }
  void operator()(const PrintPage::Line& line) {
    text += fmt::format(
        "<line x1=\"{:.3f}\" y1=\"{:.3f}\" x2=\"{:.3f}\" y2=\"{:.3f}\" stroke=\"black\" "
        "stroke-width=\"{:g}\"/>\n",
        line.from_mm.x(), height_mm - line.from_mm.y(), line.to_mm.x(), height_mm - line.to_mm.y(),
        line.width_mm);
  }
  void operator()(const PrintPage::Text& words) {
    constexpr std::array kAnchors{"start", "middle", "end"};
    text += fmt::format(
        "<text x=\"{:.3f}\" y=\"{:.3f}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{:g}\" "
        "text-anchor=\"{}\">{}</text>\n",
        words.p_mm.x(), height_mm - words.p_mm.y(), words.height_mm,
        kAnchors.at(static_cast<std::size_t>(words.anchor)), base::escapeHtml(words.text));
  }
};

/// UTF-8 as the bytes of a PDF string in WinAnsiEncoding, which has Latin-1's characters at their places.
std::string pdfString(const std::string& utf8) {
  std::string out = "(";
  for (std::size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = static_cast<std::uint8_t>(utf8[i]);
    std::uint32_t code = byte;
    if (byte >= 0x80U) {
      const std::size_t more = byte >= 0xf0U ? 3 : byte >= 0xe0U ? 2 : 1;
      code = byte >= 0xe0U || i + 1 >= utf8.size()
                 ? U'?'
                 : ((byte & 0x1fU) << 6U) | (static_cast<std::uint8_t>(utf8[i + 1]) & 0x3fU);
      i += more;
    }
    if (code > 0xffU || code < 0x20U) code = U'?';
    if (code == '(' || code == ')' || code == '\\') out += '\\';
    out += static_cast<char>(static_cast<std::uint8_t>(code));
  }
  return out + ")";
}

/// Shapes as a PDF's content, in millimetres.
struct PdfShapes {
  std::string text;

  void operator()(const PrintPage::Disc& disc) {
    // A quarter of a circle as a cubic is true to 0.03 % of the radius.
    constexpr double kHandle = 4.0 / 3.0 * (std::numbers::sqrt2 - 1.0);
    const double r = disc.radius_mm;
    const Vector2d& c = disc.p_mm;
    text += fmt::format("{:.4f} {:.4f} m\n", c.x() + r, c.y());
    Vector2d out(1.0, 0.0);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Vector2d next(-out.y(), out.x());
      const Vector2d a = c + r * (out + kHandle * next), b = c + r * (next + kHandle * out),
                     end = c + r * next;
      text += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} c\n", a.x(), a.y(), b.x(), b.y(),
                          end.x(), end.y());
      out = next;
    }
    text += "f\n";
  }
  void operator()(const PrintPage::Line& line) {
    text += fmt::format("{:g} w {:.4f} {:.4f} m {:.4f} {:.4f} l S\n", line.width_mm, line.from_mm.x(),
                        line.from_mm.y(), line.to_mm.x(), line.to_mm.y());
  }
  void operator()(const PrintPage::Text& words) {
    const double width_mm = kHelveticaWidth * words.height_mm * static_cast<double>(words.text.size());
    const double back_mm = words.anchor == PrintPage::Anchor::kLeft     ? 0.0
                           : words.anchor == PrintPage::Anchor::kMiddle ? 0.5 * width_mm
                                                                        : width_mm;
    text += fmt::format("BT /F1 {:g} Tf {:.4f} {:.4f} Td {} Tj ET\n", words.height_mm,
                        words.p_mm.x() - back_mm, words.p_mm.y(), pdfString(words.text));
  }
};

}  // namespace

void PrintPage::arrow(const Vector2d& from_mm, const Vector2d& to_mm) {
  const Vector2d along = (to_mm - from_mm).normalized();
  const Vector2d across(-along.y(), along.x());
  shapes.emplace_back(Line{from_mm, to_mm});
  for (const double side : {1.0, -1.0})
    shapes.emplace_back(Line{to_mm, to_mm + kBarb_mm * (side * 0.4 * across - along)});
}

std::string svgOf(const PrintPage& page) {
  SvgShapes shapes{page.size_mm.y(), {}};
  for (const PrintPage::Shape& shape : page.shapes) std::visit(shapes, shape);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 "
      "{0:.3f} "
      "{1:.3f}\">\n{2}</svg>\n",
      page.size_mm.x(), page.size_mm.y(), shapes.text);
}

std::string pdfOf(const PrintPage& page) {
  PdfShapes shapes{fmt::format("{0:.8f} 0 0 {0:.8f} 0 0 cm\n", kPointsPerMm)};
  for (const PrintPage::Shape& shape : page.shapes) std::visit(shapes, shape);
  const Vector2d size_pt = kPointsPerMm * page.size_mm;
  const std::array<std::string, 5> objects{
      "<</Type /Catalog /Pages 2 0 R>>", "<</Type /Pages /Kids [3 0 R] /Count 1>>",
      fmt::format(
          "<</Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 4 0 R /Resources <</Font "
          "<</F1 5 0 R>>>>>>",
          size_pt.x(), size_pt.y()),
      fmt::format("<</Length {}>>\nstream\n{}endstream", shapes.text.size(), shapes.text),
      "<</Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding>>"};
  std::string pdf = "%PDF-1.4\n";
  std::string places = "0000000000 65535 f \n";
  for (std::size_t k = 0; k < objects.size(); ++k) {
    places += fmt::format("{:010} 00000 n \n", pdf.size());
    pdf += fmt::format("{} 0 obj\n{}\nendobj\n", k + 1, objects[k]);
  }
  const std::size_t table = pdf.size();
  return pdf + fmt::format("xref\n0 {0}\n{1}trailer\n<</Size {0} /Root 1 0 R>>\nstartxref\n{2}\n%%EOF\n",
                           objects.size() + 1, places, table);
}

}  // namespace kerfbench::head_service
