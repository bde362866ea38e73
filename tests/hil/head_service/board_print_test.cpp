// SPDX-License-Identifier: Apache-2.0
// Boards to print, as SVG and as PDF.
#include "hil/head_service/board_print.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include <fmt/format.h>

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

calibrate::MarkJob job() {
  calibrate::MarkJob job;
  job.name = "1-grid";
  job.machine = "cutter (hall 2) <a>";
  job.date = "2026-11-22";
  job.size_mm = 5.0;
  job.p_SW_mm = {-67.0, 0.0};
  for (const double x : {-62.0, 1.0, 62.0})
    for (const double y : {-60.0, 60.0}) job.print.push_back({job.p_SW_mm + Vector2d(x, y), 3.0});
  job.marks = calibrate::numbered(calibrate::gridPlaces({Vector2d(-50, -50), Vector2d(50, 50)}, 3), 0);
  return job;
}

PrintPage page() { return boardPrint(job(), {2, {"Printed at 100 %.", "Lay it.", "Cut it."}}); }

TEST(BoardPrint, HasTheJobsMarksTrueToScaleAndNothingElseWhereMarksAreCutOrLookedFor) {
  const PrintPage printed = page();
  std::vector<Vector2d> discs;
  for (const PrintPage::Shape& shape : printed.shapes)
    if (const auto* disc = std::get_if<PrintPage::Disc>(&shape)) discs.push_back(disc->p_mm);
  const calibrate::MarkJob wanted = job();
  ASSERT_EQ(discs.size(), wanted.print.size());
  Eigen::AlignedBox2d clear;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    EXPECT_LT((discs[i] - discs[0] - wanted.print[i].p_SM_mm + wanted.print[0].p_SM_mm).norm(), 1e-12);
    clear.extend(discs[i] - Vector2d::Constant(1.5 + 3.0));
    clear.extend(discs[i] + Vector2d::Constant(1.5 + 3.0));
  }
  for (const PrintPage::Shape& shape : printed.shapes) {
    if (const auto* line = std::get_if<PrintPage::Line>(&shape)) {
      EXPECT_FALSE(clear.contains(line->from_mm) || clear.contains(line->to_mm)) << line->from_mm.transpose();
      EXPECT_FALSE(clear.contains(Vector2d(0.5 * (line->from_mm + line->to_mm))));
    } else if (const auto* text = std::get_if<PrintPage::Text>(&shape)) {
      EXPECT_FALSE(clear.contains(text->p_mm)) << text->text;
    }
  }
}

TEST(BoardPrint, SaysWhatItIsAndWhatIsToBeDone) {
  const std::string svg = svgOf(page());
  EXPECT_THAT(svg, HasSubstr("cutter (hall 2) &lt;a&gt; · 1-grid · sheet 2 · 2026-11-22"));
  for (const char* words : {">1. Printed at 100 %.<", ">3. Cut it.<", ">+x, the belt runs this way<", ">+y<",
                            ">x = 0<", ">y = 0<", ">130<", ">120<"})
    EXPECT_THAT(svg, HasSubstr(words));
  EXPECT_EQ(rulersOf(job()), Vector2d(130.0, 130.0));
  EXPECT_EQ(svg, svgOf(page()));
  EXPECT_THAT(svg, HasSubstr(fmt::format("width=\"{:.3f}mm\"", page().size_mm.x())));
}

/// The objects of a PDF by its own table.
TEST(PrintPagePdf, ItsTableLeadsToItsObjectsAndItsStreamIsAsLongAsItSays) {
  const std::string pdf = pdfOf(page());
  EXPECT_EQ(pdf.rfind("%PDF-1.4\n", 0), 0U);
  const std::size_t start = std::stoul(pdf.substr(pdf.find("startxref\n") + 10));
  ASSERT_EQ(pdf.substr(start, 4), "xref");
  std::size_t entry = pdf.find(" f \n", start) + 4;
  for (int object = 1; object <= 5; ++object, entry += 20)
    EXPECT_EQ(pdf.substr(std::stoul(pdf.substr(entry, 10)), 7), fmt::format("{} 0 obj", object));
  const std::size_t length = std::stoul(pdf.substr(pdf.find("/Length ") + 8));
  const std::size_t stream = pdf.find("stream\n") + 7;
  EXPECT_EQ(pdf.substr(stream + length, 9), "endstream");
  // 72 points an inch.
  EXPECT_THAT(pdf, HasSubstr(fmt::format("/MediaBox [0 0 {:.4f} {:.4f}]", page().size_mm.x() * 72.0 / 25.4,
                                         page().size_mm.y() * 72.0 / 25.4)));
  EXPECT_THAT(pdf, HasSubstr("(cutter \\(hall 2\\) <a> \xb7 1-grid"));
}

}  // namespace
}  // namespace kerfbench::head_service
