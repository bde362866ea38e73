// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"
#include "tests/hil/dieline/pdf_writer.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kInch_mm = 25.4;

Dieline readPage(const std::string& content, const PdfPage& page = {},
                 const LayerProfile& profile = defaultLayerProfile()) {
  return readText(".pdf", pdfPage(content, page), profile);
}
std::string pageFaults(const std::string& content, const PdfPage& page = {}) {
  return faultsOf(".pdf", pdfPage(content, page));
}
std::vector<std::string> layersOf(const Dieline& dieline) {
  std::vector<std::string> layers;
  for (const Entity& entity : dieline.entities) layers.push_back(entity.layer);
  return layers;
}
/// "cut crease ..." of all entities.
std::string processesOf(const Dieline& dieline) {
  std::string text;
  for (const Entity& entity : dieline.entities)
    text += (text.empty() ? "" : " ") + std::string(processName(entity.process));
  return text;
}
Vector2d startOf(const Dieline& dieline, std::size_t i) { return pointAt(dieline.entities.at(i).curve, 0); }

TEST(Pdf, PathsAreExact) {
  const Dieline dieline = readPage(
      "1 0 0 RG 72 72 m 144 72 l 144 72 180 108 216 72 c 252 72 252 108 v 270 108 288 144 y h S\n"
      "72 144 72 36 re s 0 0 m 36 36 l 72 0 m 108 36 l S");
  ASSERT_EQ(dieline.entities.size(), 5U + 4U + 2U);
  const auto& bezier = std::get<BezierCurve>(dieline.entities[1].curve);
  EXPECT_NEAR((bezier.control_mm.col(2) - kInch_mm * Vector2d(2.5, 1.5)).norm(), 0, 1e-12);
  const auto& v = std::get<BezierCurve>(dieline.entities[2].curve);
  EXPECT_EQ(v.control_mm.col(0), v.control_mm.col(1));
  const auto& y = std::get<BezierCurve>(dieline.entities[3].curve);
  EXPECT_EQ(y.control_mm.col(2), y.control_mm.col(3));
  EXPECT_NEAR((pointAt(dieline.entities[4].curve, 1) - kInch_mm * Vector2d(1, 1)).norm(), 0, 1e-12);
  double rectangle_mm = 0;
  for (std::size_t i = 5; i < 9; ++i) rectangle_mm += lengthOf(dieline.entities[i].curve);
  EXPECT_NEAR(rectangle_mm, 3 * kInch_mm, 1e-9);
  EXPECT_EQ(dieline.entities[0].origin, "path 1");
  EXPECT_EQ(dieline.entities[10].origin, "path 3");
}

TEST(Pdf, MatricesAndStatesAreStacked) {
  const Dieline dieline = readPage(
      "1 0 0 RG q 2 0 0 2 72 0 cm q 0 1 -1 0 36 0 cm 0 0 m 36 0 l S Q 0 0 m 36 0 l S Q "
      "0 0 m 36 0 l S Q Q 0 0 m 72 0 l S");
  ASSERT_EQ(dieline.entities.size(), 4U);
  EXPECT_NEAR((startOf(dieline, 0) - kInch_mm * Vector2d(2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((pointAt(dieline.entities[0].curve, 1) - kInch_mm * Vector2d(2, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((pointAt(dieline.entities[1].curve, 1) - kInch_mm * Vector2d(2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(lengthOf(dieline.entities[2].curve), kInch_mm / 2, 1e-12);
  EXPECT_NEAR(lengthOf(dieline.entities[3].curve), kInch_mm, 1e-12);
}

/// The lower left corner of what a viewer shows is the origin.
TEST(Pdf, PageIsPlacedAsItIsShown) {
  const auto at = [](const std::string& keys) {
    const Dieline dieline = readPage("1 0 0 RG 72 144 m 108 144 l S", {.keys = keys});
    return std::pair(Vector2d(startOf(dieline, 0) / kInch_mm),
                     Vector2d(pointAt(dieline.entities[0].curve, 1) / kInch_mm));
  };
  const auto expect = [&](const std::string& keys, const Vector2d& start, const Vector2d& end) {
    const auto [p, q] = at(keys);
    EXPECT_NEAR((p - start).norm() + (q - end).norm(), 0, 1e-12) << keys;
  };
  expect("/MediaBox [0 0 720 360]", {1, 2}, {1.5, 2});
  expect("/MediaBox [720 360 0 0]", {1, 2}, {1.5, 2});
  expect("/MediaBox [36 -36 720 360]", {0.5, 2.5}, {1, 2.5});
  expect("/MediaBox [0 0 720 360] /CropBox [36 72 360 360]", {0.5, 1}, {1, 1});
  expect("/MediaBox [0 0 720 360] /Rotate 90", {2, 9}, {2, 8.5});
  expect("/MediaBox [0 0 720 360] /Rotate 180", {9, 3}, {8.5, 3});
  expect("/MediaBox [0 0 720 360] /Rotate -90", {3, 1}, {3, 1.5});
  expect("/MediaBox [0 0 720 360] /UserUnit 10", {10, 20}, {15, 20});
  EXPECT_THAT(pageFaults("", {.keys = ""}), HasSubstr("no MediaBox"));
  EXPECT_THAT(pageFaults("", {.keys = "/MediaBox [0 0 9 9] /Rotate 45"}), HasSubstr("turned by 45 degrees"));
}

TEST(Pdf, SizesAreInheritedAlongThePageTree) {
  const Dieline dieline = readText(
      ".pdf",
      pdfOf({"<< /Pages 2 0 R >>",
             "<< /Type /Pages /Kids [3 0 R] /Count 1 /MediaBox [0 0 200 200] /Rotate 90 /Resources << "
             "/XObject << /F 6 0 R >> >> >>",
             "<< /Type /Pages /Parent 2 0 R /Kids [4 0 R] /Count 1 >>",
             "<< /Type /Page /Parent 3 0 R /Contents [5 0 R 5 0 R] >>", pdfStream("/F Do"),
             pdfForm("1 0 0 RG 0 0 m 72 0 l S")}));
  EXPECT_EQ(dieline.entities.size(), 2U);
  EXPECT_NEAR(startOf(dieline, 0).y(), 200.0 / 72 * kInch_mm, 1e-9);
}

TEST(Pdf, ColoursAreLayers) {
  const LayerProfile all{"own", {{"*", Process::kCut}}};
  EXPECT_THAT(
      layersOf(readPage("0 0 m 9 9 l S 0.5 G 0 0 m 9 9 l S 1 0 0 RG 0 0 m 9 9 l S 0 0 0 1 K 0 0 m 9 9 l S\n"
                        "/DeviceRGB CS 0 0 m 9 9 l S 0 1 0.2 SC 0 0 m 9 9 l S /DeviceCMYK CS 0 0 m 9 9 l S",
                        {}, all)),
      ElementsAre("#000000", "#808080", "#ff0000", "cmyk 0 0 0 100", "#000000", "#00ff33", "cmyk 0 0 0 100"));
  const LayerProfile cyan{"own",
                          {{"cmyk 0 100 100 0", Process::kCrease}, {"#00ffff", Process::kPerforation}}};
  EXPECT_EQ(processesOf(readPage("0 1 1 0 K 0 0 m 9 9 l S 1 0 0 0 K 0 0 m 9 9 l S", {}, cyan)),
            "crease perforation");
  EXPECT_THAT(
      pageFaults("0.3 0 0.1 RG 0 0 m 9 9 l S"),
      HasSubstr("path 1 is known as '#4d001a', and the profile 'default' has a rule for none of them"));
}

TEST(Pdf, ManyStrokesWithoutARuleAreOneFault) {
  std::string content = "0.3 0 0.1 RG ";
  for (int i = 0; i < 300; ++i) content += "0 0 m 9 9 l S ";
  const std::string faults = pageFaults(content + "0 0.3 0.1 RG 0 0 m 9 9 l S");
  EXPECT_THAT(faults, HasSubstr("path 1 (and 299 others likewise) is known as '#4d001a'"));
  EXPECT_THAT(faults, HasSubstr("path 301 is known as '#004d1a'"));
  EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 1);
}

TEST(Pdf, SpotColoursAreLayersByTheirNames) {
  const PdfPage page{.resources =
                         "/ColorSpace << /A [/Separation /Dieline /DeviceCMYK 9 0 R] /B [/Separation "
                         "/CutContour /DeviceCMYK 9 0 R] /C [/Separation /Kiss#20Cut /DeviceRGB 9 0 R] /D "
                         "[/DeviceN [/Crease /None] /DeviceCMYK 9 0 R] /E [/Separation /None /DeviceGray 9 0 "
                         "R] /I [/ICCBased 5 0 R] /L [/Lab << >>] >>",
                     .objects = {pdfStream("", "/N 3")}};
  const Dieline dieline = readPage(
      "/A CS 0 0 m 9 9 l S 1 SCN 0 0 m 9 9 l S /B CS 0.4 SC 0 0 m 9 9 l S\n"
      "/C CS 0 0 m 9 9 l S /D CS 1 1 SCN 0 0 m 9 9 l S /E CS 1 SCN 0 0 m 9 9 l S\n"
      "/A CS 0 SCN 0 0 m 9 9 l S /I CS 0 0 1 SCN 0 0 m 9 9 l S",
      page);
  EXPECT_THAT(layersOf(dieline),
              ElementsAre("Dieline", "Dieline", "CutContour", "Kiss Cut", "Crease", "#0000ff"));
  EXPECT_EQ(processesOf(dieline), "cut cut cut half-cut crease crease");
  EXPECT_THAT(dieline.notes, ElementsAre("Ignored: 2 strokes without ink."));
  EXPECT_THAT(pageFaults("/L CS 0 0 m 9 9 l S", page), HasSubstr("'colours of Lab'"));
  EXPECT_THAT(pageFaults("/X CS 0 0 m 9 9 l S", page),
              HasSubstr("colour space 'X', which is not in the file"));
}

/// Groups 5 Cut, 6 Notes, 7 Hidden.
PdfPage layered(const std::string& defaults = "", const std::string& properties = "") {
  return {
      .resources = "/Properties << /A 5 0 R /B 6 0 R /C 7 0 R " + properties + " >> /XObject << /F 8 0 R >>",
      .catalogue = "/OCProperties << /OCGs [5 0 R 6 0 R 7 0 R] /D << " + defaults + " >> >>",
      .objects = {"<< /Type /OCG /Name (Cut) >>", "<< /Type /OCG /Name (Notes) >>",
                  "<< /Type /OCG /Name <FEFF00480069006400640065006E> >>",
                  pdfForm("0 0 m 9 9 l S", "", "/OC 6 0 R")}};
}

TEST(Pdf, LayersNameProcesses) {
  const std::string colour = "0.2 0.4 0.6 RG ";
  const Dieline dieline = readPage(colour +
                                       "/OC /A BDC 0 0 m 9 9 l S /OC /B BDC 0 0 m 9 9 l S /P BMC 0 0 m 9 9 l "
                                       "S EMC EMC 0 0 m 9 9 l S EMC /F Do",
                                   layered());
  EXPECT_THAT(layersOf(dieline), ElementsAre("Cut", "Notes", "Notes", "Cut", "Notes"));
  EXPECT_EQ(processesOf(dieline), "cut ignore ignore cut ignore");
  EXPECT_THAT(dieline.notes, ElementsAre("Ignored by its rule: layer 'Notes', 3 lines."));
  EXPECT_THAT(pageFaults(colour + "/OC /C BDC 0 0 m 9 9 l S EMC", layered()),
              HasSubstr("is known as 'Hidden', '#336699'"));
}

TEST(Pdf, HiddenLayersAreIgnoredByNameAndCount) {
  const std::string content =
      "1 0 0 RG /OC /A BDC 0 0 m 9 9 l S EMC /OC /C BDC 0 0 m 9 9 l S 0 0 m 5 5 l S EMC /F Do";
  const Dieline off = readPage(content, layered("/OFF [7 0 R]"));
  EXPECT_THAT(layersOf(off), ElementsAre("Cut", "Notes"));
  EXPECT_THAT(off.notes, Contains("Ignored: 2 paths of the hidden layer 'Hidden'."));
  EXPECT_THAT(layersOf(readPage(content, layered("/BaseState /OFF /ON [5 0 R]"))), ElementsAre("Cut"));
}

TEST(Pdf, MembershipsFollowTheirPolicy) {
  const auto shown = [](const std::string& membership) {
    return !readPage("1 0 0 RG /OC /M BDC 0 0 m 9 9 l S EMC",
                     layered("/OFF [7 0 R]", "/M << /Type /OCMD " + membership + " >>"))
                .entities.empty();
  };
  EXPECT_TRUE(shown("/OCGs [5 0 R 7 0 R]"));
  EXPECT_TRUE(shown("/OCGs 5 0 R"));
  EXPECT_FALSE(shown("/OCGs 7 0 R"));
  EXPECT_FALSE(shown("/OCGs [5 0 R 7 0 R] /P /AllOn"));
  EXPECT_TRUE(shown("/OCGs [5 0 R 7 0 R] /P /AnyOff"));
  EXPECT_FALSE(shown("/OCGs [5 0 R 7 0 R] /P /AllOff"));
  EXPECT_FALSE(shown("/OCGs 5 0 R /VE [/And 5 0 R [/Not 5 0 R]]"));
  EXPECT_TRUE(shown("/OCGs 7 0 R /VE [/Or 7 0 R [/And 5 0 R [/Not 7 0 R]]]"));
  EXPECT_TRUE(shown(""));
}

/// A group with the processing step of ISO 19593-1.
PdfPage stepped(const std::string& group, const std::string& type, const std::string& defaults = "") {
  return {.resources = "/Properties << /A 5 0 R >>",
          .catalogue = "/OCProperties << /OCGs [5 0 R] /D << " + defaults + " >> >>",
          .objects = {"<< /Type /OCG /Name (crease) /GTS_Metadata << /GTS_ProcStepsGroup /" + group +
                      (type.empty() ? "" : " /GTS_ProcStepsType /" + type) + " >> >>"}};
}

TEST(Pdf, ProcessingStepsAreProcesses) {
  const std::string content = "0.1 0.2 0.3 RG /OC /A BDC 0 0 m 9 9 l S EMC";
  // The step counts, not what somebody called the layer.
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "Cutting"))), "cut");
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "PartialCutting"))), "half-cut");
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "Creasing"))), "crease");
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "Perforating"))), "perforation");
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "Gluing"))), "ignore");
  EXPECT_EQ(processesOf(readPage(content, stepped("Varnish", ""))), "ignore");
  EXPECT_THAT(layersOf(readPage(content, stepped("Structural", "Cutting"))),
              ElementsAre("Structural Cutting"));
  const LayerProfile own{"own", {{"structural cutting", Process::kHalfCut}, {"crease", Process::kCrease}}};
  EXPECT_EQ(processesOf(readPage(content, stepped("Structural", "Cutting"), own)), "half-cut");
  // From the other side, or cut and crease in turn: a rule must say.
  for (const char* type :
       {"ReverseCreasing", "ReversePartialCutting", "CuttingCreasing", "Drilling", "Novel"}) {
    EXPECT_THAT(pageFaults(content, stepped("Structural", type)),
                HasSubstr(fmt::format("give 'Structural {}' a rule", type)));
  }
  EXPECT_THAT(pageFaults(content, stepped("Structural", "Cutting", "/OFF [5 0 R]")),
              HasSubstr("layer 'crease' is hidden, and a processing step (Structural Cutting)"));
  EXPECT_THAT(readPage(content, stepped("Structural", "Bleed", "/OFF [5 0 R]")).notes,
              Contains(HasSubstr("hidden layer 'crease'")));
}

TEST(Pdf, SolidAndDashedStrokesOfOneLayerAreToldApart) {
  const std::string both = "1 0 0 RG 0 0 m 9 9 l S [3 2] 0 d 0 9 m 9 0 l S";
  EXPECT_THAT(pageFaults(both),
              HasSubstr("'#ff0000' has solid and dashed strokes, and one rule for both; give the "
                        "dashed ones a rule of their own, '#ff0000 dashed'"));
  const LayerProfile own{"own", {{"#ff0000", Process::kCut}, {"#FF0000 dashed", Process::kPerforation}}};
  EXPECT_EQ(processesOf(readPage(both, {}, own)), "cut perforation");
  EXPECT_EQ(processesOf(readPage("1 0 0 RG [3 2] 0 d 0 0 m 9 9 l S q 1 0 0 RG 0 9 m 9 0 l S Q")), "cut cut");
  EXPECT_EQ(processesOf(readPage("1 0 0 RG 0 0 m 9 9 l S [] 0 d 0 9 m 9 0 l S [0] 0 d 0 9 m 9 0 l S")),
            "cut cut cut");
  EXPECT_THAT(pageFaults("1 0 0 RG /G gs 0 0 m 9 9 l S /H gs 0 9 m 9 0 l S",
                         {.resources = "/ExtGState << /G << /D [[1 1] 0] >> /H << /D [[] 0] >> >>"}),
              HasSubstr("solid and dashed"));
}

TEST(Pdf, WhatIsNoStrokeIsIgnoredByNameAndCount) {
  const PdfPage page{.resources = "/XObject << /I 5 0 R >> /ExtGState << /G << /CA 0 >> >>",
                     .keys = "/MediaBox [0 0 720 360] /Annots [<< /Subtype /Link >>]",
                     .objects = {pdfStream("x", "/Subtype /Image /Width 1 /Height 1")}};
  const Dieline dieline = readPage(
      "1 0 0 RG 0 0 9 9 re f 0 0 9 9 re B* BT /F1 12 Tf (a \\) b) Tj [(c) -3 <64>] TJ ET /I Do /S sh\n"
      "BI /W 1 /H 1 /IM true ID xEIy EI % a comment\n5 5 m 5 5 l S 7 7 m S /G gs 0 0 m 9 9 l S /Tag << /MCID "
      "0 >> BDC "
      "EMC BX what EX",
      page);
  EXPECT_EQ(dieline.entities.size(), 4U);
  EXPECT_THAT(
      dieline.notes,
      ElementsAre("Ignored: 1 dots, 1 fills, 1 fills of stroked paths, 2 images, 1 shadings, 1 strokes of "
                  "opacity 0, 2 texts, 1 annotations."));
  EXPECT_THAT(readPage("0 0 9 9 re f").notes, Contains(HasSubstr("No line of the page is stroked")));
  EXPECT_THAT(pageFaults("/G gs 1 0 0 RG 0 0 m 9 9 l S",
                         {.resources = "/ExtGState << /G << /SMask << /S /Alpha >> >> >>"}),
              HasSubstr("under a soft mask"));
}

TEST(Pdf, ClipsKeepWhatIsInside) {
  const auto read = [](const std::string& clip) {
    return readPage("1 0 0 RG q " + clip +
                    " W n 100 100 m 140 140 l S 300 300 40 40 re S Q 300 300 m 301 301 l S");
  };
  EXPECT_EQ(read("90 90 60 60 re").entities.size(), 2U);
  EXPECT_THAT(read("90 90 60 60 re").notes, Contains(HasSubstr("4 lines outside of page or clip")));
  // A triangle, an even-odd ring, and a clip along the lines themselves, as clipping groups have it.
  EXPECT_EQ(read("95 90 m 160 90 l 160 160 l 95 160 l h").entities.size(), 2U);
  EXPECT_EQ(read("0 0 m 300 0 l 0 300 l h").entities.size(), 2U);
  EXPECT_EQ(read("100 100 m 140 140 l 90 140 l h").entities.size(), 2U);
  EXPECT_EQ(read("50 50 150 150 re 80 80 90 90 re 290 290 60 60 re W* n 0 0 720 360 re").entities.size(), 5U);
  EXPECT_EQ(read("300 300 40 40 re").entities.size(), 5U);
  for (const char* across :
       {"90 90 30 30 re", "0 0 m 240 0 l 0 240 l h", "90 120 m 120 90 200 200 90 200 c h"}) {
    EXPECT_THAT(pageFaults("1 0 0 RG q " + std::string(across) + " W n 100 100 m 140 140 l S Q"),
                HasSubstr("path 1, from (35.278, 35.278) mm, is cut off by its clip"))
        << across;
  }
}

TEST(Pdf, LinesAcrossTheEdgeOfThePageAreRefused) {
  EXPECT_EQ(readPage("1 0 0 RG 0 0 720 360 re S").entities.size(), 4U);
  EXPECT_THAT(pageFaults("1 0 0 RG 100 100 m 800 100 l S"), HasSubstr("the edge of the page"));
  EXPECT_THAT(readPage("1 0 0 RG 800 100 m 900 100 l S 0 0 m 9 9 l S").notes,
              ElementsAre("Ignored: 1 lines outside of page or clip."));
}

TEST(Pdf, FormsAreDrawnWithTheirMatrixAndBox) {
  const PdfPage page{
      .resources = "/XObject << /F 5 0 R >>",
      .objects = {pdfStream("0 0 m 36 0 l S /G Do",
                            "/Subtype /Form /Matrix [0 1 -1 0 72 0] /BBox [-1 -1 40 40] /Resources << "
                            "/XObject << /G 6 0 R >> >>"),
                  pdfForm("q 50 50 m 60 60 l S 1 0 0 RG 10 10 m 20 10 l S Q Q Q EMC EMC")}};
  const Dieline dieline = readPage("0 0 1 RG q 2 0 0 2 0 0 cm /F Do Q 0 0 m 36 0 l S", page);
  ASSERT_EQ(dieline.entities.size(), 3U);
  EXPECT_EQ(processesOf(dieline), "crease cut crease");
  EXPECT_NEAR((startOf(dieline, 0) - kInch_mm * Vector2d(2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((startOf(dieline, 1) - kInch_mm * Vector2d(2 - 20.0 / 72, 20.0 / 72)).norm(), 0, 1e-12);
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("1 lines outside")));
  EXPECT_NEAR(lengthOf(dieline.entities[2].curve), kInch_mm / 2, 1e-12);
}

TEST(Pdf, OnlyOnePageIsADrawing) {
  const std::string leaf = "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 9 9] >>";
  EXPECT_THAT(
      faultsOf(".pdf", pdfOf({"<< /Pages 2 0 R >>", "<< /Kids [3 0 R 4 0 R] /Count 2 >>", leaf, leaf})),
      HasSubstr("has 2 pages, and a drawing is one; say which with dieline: {page: N} or --page N"));
  EXPECT_THAT(faultsOf(".pdf", pdfOf({"<< /Pages 2 0 R >>", "<< /Kids [2 0 R] >>"})),
              HasSubstr("has no page"));
}

TEST(Pdf, OneOfSeveralPagesIsNamed) {
  const auto leaf = [](int content) {
    return fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 720 720] /Contents {} 0 R >>", content);
  };
  const std::string file =
      pdfOf({"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R 7 0 R] /Count 3 >>", leaf(4),
             pdfStream("1 0 0 RG 0 0 m 72 0 l S"), leaf(6), pdfStream("1 0 0 RG 0 0 m 144 0 l S"),
             "<< /Type /Pages /Parent 2 0 R /Kids [5 0 R 8 0 R] /Count 2 >>", leaf(9),
             pdfStream("1 0 0 RG 0 0 m 216 0 l S")});
  for (const int page : {1, 2, 3}) {
    DrawingOptions options;
    options.page = page;
    const Dieline dieline = readText(".pdf", file, options);
    ASSERT_EQ(dieline.entities.size(), 1U);
    EXPECT_NEAR(lengthOf(dieline.entities[0].curve), page * 25.4, 1e-9) << page;
  }
  DrawingOptions beyond;
  beyond.page = 4;
  EXPECT_THAT(faultsOf(".pdf", file, beyond), HasSubstr("has 3 pages, and no page 4"));
  beyond.page = 2;
  EXPECT_THAT(faultsOf(".pdf", pdfPage("1 0 0 RG 0 0 m 9 9 l S"), beyond),
              HasSubstr("has 1 page, and no page 2"));
  EXPECT_THAT(faultsOf(".svg", svg("<path d='M0 0L9 9' stroke='red'/>"), beyond),
              HasSubstr("only a PDF has pages"));
}

TEST(Pdf, AUnitIsRefused) {
  DrawingOptions options;
  options.unit = DrawingUnit::kMillimetre;
  EXPECT_THAT(faultsOf(".pdf", pdfPage("1 0 0 RG 0 0 m 9 9 l S"), options),
              HasSubstr("a PDF file says its unit itself: leave 'unit' out, or use 'scale'"));
  options = {};
  options.scale = 2;
  EXPECT_EQ(faultsOf(".pdf", pdfPage("1 0 0 RG 0 0 m 9 9 l S"), options), "");
}

/// Lines that a rule ignores are told in every format.
TEST(Pdf, IgnoredLayersAreToldAsInOtherFormats) {
  const std::string told = "Ignored by its rule: layer ";
  DrawingOptions options;
  options.layers = {"test", {{"*", Process::kIgnore}}};
  EXPECT_THAT(readText(".pdf", pdfPage("1 0 0 RG 0 0 m 9 9 l S"), options).notes,
              Contains(told + "'#ff0000', 1 lines."));
  EXPECT_THAT(readText(".svg", svg("<path d='M0 0L9 9' stroke='red'/>"), options).notes,
              Contains(told + "'#ff0000', 1 lines."));
  EXPECT_THAT(readText(".dxf", dxf("0|LINE|8|A|10|0|20|0|11|3|21|0"), options).notes,
              Contains(told + "'A', 1 lines."));
  EXPECT_THAT(readText(".cf2", "$BOF\nV2\nMAIN,BOX\nUM\nL,2,1,0,0,0,50,0,0,0\nEND\n$EOF\n", options).notes,
              Contains(told + "'CF2 type 1', 1 lines."));
}

TEST(Pdf, ContentTellsTheFormatOfOtherExtensions) {
  EXPECT_EQ(readText(".ai", pdfPage("1 0 0 RG 0 0 m 9 9 l S")).entities.size(), 1U);
}

}  // namespace
}  // namespace kerfbench::dieline
